"""Sharded datasets in a bucket, read over S3, and what happens without the packages for it."""

from __future__ import annotations

import json
import multiprocessing
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fathom
import httpx
import numpy as np
import pytest
from conftest import description

SERVER = Path(__file__).parents[3] / "tests/cluster/s3_server.py"
FRAMES = 5


@pytest.fixture
def bucket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """Start an S3 server with an empty bucket, to which the environment leads."""
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        address = f"http://127.0.0.1:{listener.getsockname()[1]}"
    command = [sys.executable, str(SERVER), address.rsplit(":", 1)[1], str(tmp_path / "objects")]
    settings = {"ENDPOINT_URL": address, "REGION": "us-east-1", "DEFAULT_REGION": "us-east-1"}
    settings |= {"ACCESS_KEY_ID": "key", "SECRET_ACCESS_KEY": "hush-hush"}
    for name, value in settings.items():
        monkeypatch.setenv(f"AWS_{name}", value)
    with subprocess.Popen(command) as process:
        deadline = time.monotonic() + 30
        while True:
            try:
                assert httpx.put(f"{address}/reef").status_code == 200
                break
            except httpx.ConnectError:
                assert time.monotonic() < deadline, "the S3 server does not listen"
                time.sleep(0.05)
        yield "s3://reef"
        process.kill()


def _read(frames: fathom.Frames, index: int) -> tuple[int, bytes]:
    frame = frames.read(index)
    return frame.index, frame.rgb.tobytes()


@pytest.mark.filterwarnings("ignore:.*multi-threaded.*:DeprecationWarning")
def test_a_sharded_dataset_opens_from_a_bucket(bucket: str, tmp_path: Path) -> None:
    pytest.importorskip("s3fs", reason="s3fs is not installed: buckets are not tested")
    job = fathom.Job(description(count=FRAMES, artifacts=["rgb", "range"]))
    (tmp_path / "job.json").write_text(job.canonical)
    command = [sys.executable, "-m", "fathom", "render", str(tmp_path / "job.json"), "--out", f"{bucket}/tour"]
    made = subprocess.run([*command, "--frames-per-shard", "2"], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    frames = fathom.open(f"{bucket}/tour")
    assert repr(frames.source) == f"<sharded dataset {bucket}/tour: 5 frames, 3 of 3 shards>"
    for index in range(FRAMES):
        here, stored = job.read(index, ["rgb", "range"]), frames.read(index)
        assert (stored.rgb == here.rgb).all()
        assert np.nanmax(np.abs(stored.range_m - here.range_m)) < 0.001
    expected = [_read(frames, index) for index in range(FRAMES)]
    for method in ("fork", "spawn"):
        with multiprocessing.get_context(method).Pool(2) as pool:
            assert pool.starmap(_read, [(frames, index) for index in range(FRAMES)], chunksize=1) == expected
    with pytest.raises(fathom.MissingFrames, match="s3://reef/nothing holds neither"):
        fathom.open(f"{bucket}/nothing")


def _run_without(package: str, code: str, tmp_path: Path) -> dict[str, Any]:
    """Run code in a process in which a package cannot be imported, and return the exception that it raises."""
    program = f"""
import json, sys
sys.modules[{package!r}] = None
import fathom
try:
    {code}
except Exception as error:
    print(json.dumps({{"names": [kind.__name__ for kind in type(error).__mro__], "message": str(error)}}))
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, env=os.environ)
    assert ran.returncode == 0, ran.stderr
    found: dict[str, Any] = json.loads(ran.stdout)
    return found


@pytest.mark.parametrize(
    ("package", "code", "remedy"),
    [
        ("fsspec", "fathom.open('s3://reef/tour')", "pip install 'fathom-datasets[buckets]'"),
        ("s3fs", "fathom.open('s3://reef/tour')", "pip install 'fathom-datasets[buckets]'"),
        ("fsspec", "fathom.open('memory://reef/tour')", "pip install 'fathom-datasets[buckets]'"),
        ("httpx", "fathom.Client()", "pip install 'fathom-datasets[client]'"),
        ("pandas", "fathom.client.Rows().to_pandas()", "pip install pandas"),
        ("pyarrow", "fathom.client.Rows().to_arrow()", "pip install pyarrow"),
    ],
)
def test_a_missing_package_is_named_with_its_remedy(package: str, code: str, remedy: str, tmp_path: Path) -> None:
    if package != "fsspec" and code.startswith("fathom.open"):
        pytest.importorskip("fsspec")
    code = f"import fathom.client; {code}" if "Rows" in code else code
    raised = _run_without(package, code, tmp_path)
    assert {"MissingPackage", "FathomError", "ImportError"} <= set(raised["names"]), raised
    assert package in raised["message"]
    assert raised["message"].endswith(remedy)


def test_an_unknown_kind_of_url_is_an_argument_error() -> None:
    pytest.importorskip("fsspec")
    with pytest.raises(fathom.InvalidArgument, match=r"`place` is gopher://reef: .*; must be a folder or a URL"):
        fathom.open("gopher://reef")
