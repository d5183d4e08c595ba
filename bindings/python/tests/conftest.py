"""What the tests share: small jobs, folders of `fathom render`, a service."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fathom
import pytest

KINDS = ["rgb", "range", "semantics", "instances", "normals", "transmittance", "boxes"]
BINARY = os.environ.get("FATHOM", "fathom")

# A stand-in for torch, which is too large to install for a test.
sys.path.insert(0, str(Path(__file__).parent / "stand_in"))


def description(**changes: Any) -> dict[str, Any]:
    """Describe eight small frames with water, snow and every kind of label."""
    return {
        "dataset": "python",
        "count": 8,
        "seed": 7,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000]}},
        "camera": {"width": 96, "height": 64},
        "water": {"optics": "jerlov-1C", "range_scale": {"uniform": [0.2, 1.0]}},
        "artifacts": KINDS,
    } | changes


@pytest.fixture(scope="session")
def job() -> fathom.Job:
    return fathom.Job(description())


@pytest.fixture(scope="session")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Make a folder of the binary's `fathom render`."""
    place = tmp_path_factory.mktemp("rendered")
    (place / "job.json").write_text(json.dumps(description()))
    command = [BINARY, "render", str(place / "job.json"), "--out", str(place / "frames"), "--slots", "1"]
    subprocess.run(command, check=True, capture_output=True)
    return place / "frames"


@contextmanager
def run_service(data: Path, *options: str, **environment: str) -> Iterator[str]:
    """Run the service that the wheel carries on a free port, and return its address."""
    command = [sys.executable, "-m", "fathom", "serve", "--listen", "127.0.0.1:0", "--data", str(data), *options]
    environment = {**os.environ, "FATHOM_LOG": "warn", "FATHOM_SLOTS": "1", **environment}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        address = next((found[1] for line in process.stderr if (found := re.search(r"listens on (\S+)", line))), None)
        assert address is not None, "the service did not start"
        try:
            yield address
        finally:
            process.terminate()
            process.stderr.read()
            assert process.wait(30) == 0


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Run a service with a token and a worker process."""
    with run_service(tmp_path_factory.mktemp("service"), FATHOM_TOKEN="secret") as address:
        yield address


@pytest.fixture
def no_torch(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hide the stand-in for torch from libraries that use the real one where it is there."""
    monkeypatch.setattr(sys, "path", [place for place in sys.path if not place.endswith("stand_in")])
    for name in [name for name in sys.modules if name.split(".")[0] == "torch"]:
        monkeypatch.delitem(sys.modules, name)
