from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import fathom
import fathom.ros
import pytest
from fathom.ros.description import open_stream, start_description
from fathom.ros.leaves import flatten
from fathom.ros.settings import NAMES, Settings, read_settings

yaml = pytest.importorskip("yaml")

FILES = Path(fathom.ros.__file__).parent / "files"
SITES = fathom.names()["sites"]


def write_site(site: str) -> str:
    """Return the parameter file of a site: every leaf of its description."""
    leaves = flatten(start_description(read_settings({"site": site}), {}))
    # The camera_info has it.
    del leaves["camera.hfov_deg"]
    lines = [f"# The site `{site}` for pictures with camera_info, with its random distributions.", "/**:"]
    lines += ["  ros__parameters:", "    mode: water"]
    for name, value in leaves.items():
        written = yaml.safe_dump(value, default_flow_style=True, width=1000).removesuffix("...\n").strip()
        lines.append(f"    {name}: {written}")
    return "\n".join(lines) + "\n"


def read_parameters(path: Path) -> dict[str, Any]:
    parameters: dict[str, Any] = yaml.safe_load(path.read_text())["/**"]["ros__parameters"]
    return parameters


@pytest.mark.parametrize("site", SITES)
def test_the_file_of_a_site_has_its_description(site: str) -> None:
    path = FILES / f"{site}.yaml"
    expected = write_site(site)
    if os.environ.get("FATHOM_WRITE"):
        path.write_text(expected)
    assert path.read_text() == expected, "the site has changed: run this test with FATHOM_WRITE=1 in the source folder"


@pytest.mark.parametrize("name", [*SITES, "live"])
def test_every_parameter_file_opens(name: str) -> None:
    given = read_parameters(FILES / f"{name}.yaml")
    settings = read_settings({key: value for key, value in given.items() if key in NAMES})
    leaves = {key: value for key, value in given.items() if key not in NAMES}
    open_stream(start_description(settings, leaves), settings)
    if name in SITES:
        assert start_description(Settings(), leaves) == start_description(read_settings({"site": name}), {})


@pytest.fixture
def launch_file(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The launch file with stand-ins for the package `launch`, which is not on PyPI."""
    stand_ins: dict[str, dict[str, Any]] = {
        "launch": {"LaunchDescription": list},
        "launch.actions": {
            "DeclareLaunchArgument": lambda name, **fields: SimpleNamespace(name=name, **fields),
            "ExecuteProcess": SimpleNamespace,
            "OpaqueFunction": SimpleNamespace,
        },
        "launch.substitutions": {
            "LaunchConfiguration": lambda name: SimpleNamespace(perform=lambda context: context[name])
        },
    }
    for name, members in stand_ins.items():
        module = ModuleType(name)
        module.__dict__.update(members)
        monkeypatch.setitem(sys.modules, name, module)
    spec = importlib.util.spec_from_file_location("fathom_launch", FILES / "fathom.launch.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_launch_file_starts_the_node_with_its_arguments(launch_file: ModuleType) -> None:
    *arguments, opaque = launch_file.generate_launch_description()
    context = {argument.name: argument.default_value for argument in arguments}
    [process] = opaque.function(context | {"parameters": "tank", "image": "/front/image", "name": "water"})
    command = process.cmd
    assert command[1:4] == ["-m", "fathom.ros", "--ros-args"]
    assert command[command.index("--params-file") + 1] == str(FILES / "tank.yaml")
    assert {"image:=/front/image", "depth:=depth", "camera_info:=camera_info", "__node:=water"} <= set(command)
    with pytest.raises(FileNotFoundError, match=r"`parameters` is tonk; must be .*tank"):
        opaque.function(context | {"parameters": "tonk"})


def run_node(*arguments: str, isolated: bool = True) -> subprocess.CompletedProcess[str]:
    code = "import sys; sys.modules['rclpy'] = None; from fathom.ros.__main__ import main; sys.exit(main())"
    command = [sys.executable, "-c", code, *arguments] if isolated else [sys.executable, "-m", "fathom.ros", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_command_prints_its_files_and_refuses_unknown_arguments() -> None:
    assert run_node("--files", isolated=False).stdout == f"{FILES}\n"
    assert "usage: fathom-ros" in run_node("--help").stdout
    refused = run_node("--site", "tank")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert refused.stderr == "fathom-ros: `--site` is unknown; must be --files, --help or --ros-args\n"


def test_without_ros_there_is_one_sentence_about_the_remedy() -> None:
    missing = run_node()
    assert missing.returncode == 1
    assert missing.stderr.startswith(
        "fathom-ros: `rclpy` is not installed: it is part of ROS 2 and not of this package; source"
    )
    assert missing.stderr.count("\n") == 1
