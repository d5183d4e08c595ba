from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

rosbags = pytest.importorskip("rosbags", reason="rosbags is not installed: recordings are not tested")

from conftest import BINARY  # noqa: E402
from fathom.bag import unpack  # noqa: E402
from recordings import (  # noqa: E402
    DEPTH,
    IMAGE,
    INFO,
    POSE,
    START_NS,
    STEP_NS,
    Recorder,
    make_depth,
    make_pixels,
    record_dive,
)

NAMES = ["1700000000.000000000", "1700000000.100000000", "1700000000.200000000"]


def run(*arguments: str, python: str = sys.executable) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"FATHOM_PYTHON": python}
    command = [sys.executable, "-m", "fathom", *arguments]
    if python != sys.executable:
        command = [BINARY, *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def record_poses(folder: Path, frames: int = 3) -> Path:
    with Recorder(folder, "mcap") as recorder:
        for number in range(frames):
            stamp_ns = START_NS + number * STEP_NS
            recorder.info(stamp_ns)
            recorder.odometry(stamp_ns, float(number))
            recorder.image(IMAGE, stamp_ns, "bgr8", make_pixels(number)[:, :, ::-1])
            recorder.image(DEPTH, stamp_ns, "32FC1", make_depth())
    return recorder.path


def upload(server: str, recording: Path, collection: str, *options: str) -> subprocess.CompletedProcess[str]:
    place = ["--server", server, "--token", "secret", "--collection", collection]
    return run("upload", str(recording), "--image", IMAGE, *options, *place)


def list_scenes(server: str, collection: str) -> dict[str, dict[str, Any]]:
    """Return the scenes of a collection by name."""
    place = ["--json", "--server", server, "--token", "secret"]
    listed, members = (
        [json.loads(line) for line in subprocess.check_output([BINARY, "scenes", *options, *place]).splitlines()]
        for options in ([], ["--collection", collection])
    )
    scenes = {scene["id"]: scene for scene in listed}
    return {member["name"]: scenes[member["id"]] for member in members}


def test_a_recording_becomes_scenes_with_times_poses_and_cameras(tmp_path: Path, server: str) -> None:
    topics = ["--depth", DEPTH, "--camera-info", INFO, "--pose-topic", POSE, "--pose-axes", "body"]
    result = upload(server, record_poses(tmp_path), "dive", *topics)
    assert result.returncode == 0, result.stderr
    assert "3 scenes: 3 with range, 0 without, 0 with mask, 3 with pose" in result.stderr
    scenes = list_scenes(server, "dive")
    assert sorted(scenes) == NAMES
    for number, name in enumerate(NAMES):
        scene = scenes[name]
        pose = [[0, 0, 1, number], [-1, 0, 0, 2], [0, -1, 0, -3], [0, 0, 0, 1]]
        np.testing.assert_allclose(scene["world_from_camera"], pose, atol=1e-12)
        assert scene["focal_px"] == 30
        assert (scene["cx"], scene["cy"]) == (15.5, 11.5)


def test_scenes_without_poses_and_some_frames(tmp_path: Path, server: str) -> None:
    dive = record_dive(tmp_path, "ros1")
    result = upload(server, dive, "sparse", "--depth", DEPTH, "--camera-info", INFO, "--every", "2")
    assert result.returncode == 0, result.stderr
    assert "2 scenes: 2 with range" in result.stderr
    assert sorted(list_scenes(server, "sparse")) == [NAMES[0], NAMES[2]]


def test_names_of_frames_sort_by_time(tmp_path: Path) -> None:
    with Recorder(tmp_path / "bag", "mcap") as recorder:
        for number, stamp_ns in enumerate((9_900_000_000, 10_000_000_000)):
            recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(number))
    frames = tmp_path / "frames"
    assert unpack.run([str(recorder.path), str(frames), "--image", IMAGE]) == 0
    assert sorted(file.stem for file in frames.glob("*.png")) == ["0000000009.900000000", "0000000010.000000000"]


def test_a_recording_that_is_cut_off_is_uploaded_up_to_there(tmp_path: Path, server: str) -> None:
    dive = record_dive(tmp_path, "ros1")
    dive.write_bytes(dive.read_bytes()[: int(dive.stat().st_size * 0.6)])
    result = upload(server, dive, "cut", "--camera-info", INFO)
    assert result.returncode == 1, result.stderr
    assert f"{dive} is cut off" in result.stderr
    assert "some frames are missing for the reasons above" in result.stderr
    assert sorted(list_scenes(server, "cut")) == NAMES[: len(list_scenes(server, "cut"))] != []


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--image", "/nope"], "has no topic /nope; its topics are"),
        (["--image", IMAGE, "--every", "0"], "--every is 0; must be 1 or more"),
        (["--image", IMAGE, "--unit-m", "1"], "--unit-m is for files, but"),
        ([], "is a recording; give --image TOPIC"),
    ],
)
def test_wrong_options_of_uploads_are_refused(tmp_path: Path, options: list[str], reason: str) -> None:
    dive = record_dive(tmp_path, "mcap", frames=1)
    result = run("upload", str(dive), *options)
    assert result.returncode == 2
    assert reason in result.stderr


def test_topics_of_a_picture_are_refused(tmp_path: Path) -> None:
    result = run("upload", str(tmp_path / "a.png"), "--depth", DEPTH)
    assert result.returncode == 2
    assert "--depth is for recordings, but" in result.stderr


def test_the_command_has_the_results_and_the_status_of_the_module(tmp_path: Path) -> None:
    dive = record_dive(tmp_path, "mcap", frames=1)
    (tmp_path / "job.json").write_text("{}")
    arguments = ["bag", str(dive), str(tmp_path / "wet.mcap"), "--job", str(tmp_path / "job.json")]
    assert run(*arguments, "--image", "/nope").returncode == 2
    result = run(*arguments, "--image", IMAGE)
    assert result.returncode == 0, result.stderr
    assert "1 frame written, 0 left out" in result.stderr
    assert (tmp_path / "wet.mcap").exists()


@pytest.mark.parametrize("python", ["/nonexistent/python", "empty"])
def test_a_missing_package_is_named_with_its_remedy(tmp_path: Path, python: str) -> None:
    if python == "empty":
        # An interpreter without packages.
        script = tmp_path / "python"
        script.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -S "$@"\n')
        script.chmod(0o755)
        python = str(script)
    result = run("bag", "a.bag", "b.bag", "--job", "j", "--image", "/a", python=python)
    assert result.returncode == 4
    assert "install it with `pip install 'fathom-datasets[bag]'`" in result.stderr
