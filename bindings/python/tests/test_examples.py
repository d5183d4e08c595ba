from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path

import fathom
import numpy as np
import pytest
from conftest import run_service
from fathom import _native

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_the_network_learns_from_frames_that_nobody_stored(tmp_path: Path) -> None:
    pytest.importorskip("jax")
    command = [sys.executable, str(EXAMPLES / "train_segmentation.py"), "60"]
    said = subprocess.run(command, check=True, capture_output=True, text=True, cwd=tmp_path).stdout
    losses = [float(loss) for loss in re.findall(r"loss (\S+)", said)]
    assert losses[-1] < 0.8 * losses[0], said
    assert list(tmp_path.iterdir()) == []


def test_a_trained_network_is_exported_and_compared_as_an_enhancer(tmp_path: Path) -> None:
    for package in ("jax", "onnx", "PIL"):
        pytest.importorskip(package)
    command = [sys.executable, str(EXAMPLES / "train_enhancer.py"), "1", "enhancer"]
    environment = os.environ | {"ORT_DYLIB_PATH": str(EXAMPLES.parent / ".onnxruntime/libonnxruntime.so")}
    run = subprocess.run(command, check=True, capture_output=True, text=True, cwd=tmp_path, env=environment)
    [difference] = re.findall(r"between ONNX Runtime and JAX: (\d+)", run.stdout)
    assert int(difference) <= 1, run.stdout
    rows = [line.split(" | ") for line in run.stdout.splitlines() if line.startswith(("| rgb", "| network"))]
    assert len(rows) == 8, run.stdout
    assert all(math.isfinite(float(cell)) for row in rows for cell in row[1:5]), run.stdout
    assert all(row[1] != other[1] for row, other in zip(rows[::2], rows[1::2], strict=True))
    written = {path.name for path in (tmp_path / "enhancer").iterdir()}
    assert written == {"trained.onnx", "trained.card.json", "comparison.png"}


def test_the_notebook_ran_to_its_end_without_an_error() -> None:
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(EXAMPLES / "frames.ipynb", as_version=4)
    nbformat.validate(notebook)
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    assert all(output.output_type != "error" for cell in cells for output in cell.outputs)


def test_the_best_images_of_a_dataset_are_fetched_and_plotted(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="matplotlib is not installed: the example of a dataset is not tested")
    text = (EXAMPLES / "dataset.py").read_text()
    # Fewer and smaller frames than in the example.
    small = text.replace('"count": 20,', '"count": 2, "camera": {"width": 192, "height": 123},')
    assert small != text
    (tmp_path / "dataset.py").write_text(small)
    with run_service(tmp_path / "data") as address:
        command = [sys.executable, "dataset.py", address]
        run = subprocess.run(
            command, check=True, capture_output=True, text=True, cwd=tmp_path, env=os.environ | {"MPLBACKEND": "Agg"}
        )
        rows = fathom.Client(address).images("uiqm > 0.3", dataset="example")
        frames = {f"{row['frame']:04}.png": fathom.Client(address).frame(row["job"], row["frame"]) for row in rows}
    assert "4 of 4 frames" in run.stdout
    assert run.stdout.endswith(f"{len(rows)} images; the best 8 and uiqm.png are in example/\n")
    assert len(rows) > 0
    assert {path.name for path in (tmp_path / "example").iterdir()} == {"uiqm.png", *frames}
    for name, frame in frames.items():
        assert (_native.decode((tmp_path / "example" / name).read_bytes()) == frame.rgb).all()
    assert _native.decode((tmp_path / "example/uiqm.png").read_bytes()).std() > 1


def write_video(path: Path, frames: int = 4) -> None:
    av = pytest.importorskip("av", reason="av is not installed: the example of videos is not tested")
    with av.open(str(path), "w") as video:
        stream = video.add_stream("libx264", rate=10)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        for number in range(frames):
            pixels = np.full((48, 64, 3), 60 * number, np.uint8)
            video.mux(stream.encode(av.VideoFrame.from_ndarray(pixels, format="rgb24")))
        video.mux(stream.encode())


def convert_video(folder: Path, out: str, *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(EXAMPLES / "video.py"), "dive.mp4", out, "--job", "job.json", *options]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder)


def test_a_video_is_converted_to_the_same_bytes_each_time(tmp_path: Path) -> None:
    write_video(tmp_path / "dive.mp4")
    import av

    haze = {"kind": "haze", "x": 0.5, "y": 1, "size": 0.5, "intensity": 0.5}
    (tmp_path / "job.json").write_text(json.dumps({"lights": [haze], "camera": {"sensor": {}}, "enhance": ["clahe"]}))
    for out, options in (("wet.mp4", []), ("again.mp4", []), ("clear.mp4", ["--show", "clahe"])):
        result = convert_video(tmp_path, out, *options)
        assert (result.returncode, result.stdout) == (0, f"{out}: 4 frames\n"), result.stderr
    assert (tmp_path / "wet.mp4").read_bytes() == (tmp_path / "again.mp4").read_bytes()
    assert (tmp_path / "wet.mp4").read_bytes() != (tmp_path / "clear.mp4").read_bytes()
    with av.open(str(tmp_path / "dive.mp4")) as dry, av.open(str(tmp_path / "wet.mp4")) as wet:
        pairs = list(zip(dry.decode(video=0), wet.decode(video=0), strict=True))
    assert [one.time for one, _ in pairs] == [other.time for _, other in pairs]
    first = pairs[0]
    assert first[1].to_ndarray(format="rgb24").mean() > first[0].to_ndarray(format="rgb24").mean() + 5


def test_a_video_has_the_depths_of_a_folder_or_one_distance(tmp_path: Path) -> None:
    write_video(tmp_path / "dive.mp4", frames=2)
    (tmp_path / "job.json").write_text(json.dumps({"water": {"optics": "jerlov-3C"}, "camera": {"hfov_deg": 60}}))
    for number in range(2):
        np.save(tmp_path / f"{number:06}.npy", np.full((48, 64), 4, np.float32))
    assert convert_video(tmp_path, "far.mp4", "--depth-folder", ".").returncode == 0
    assert convert_video(tmp_path, "near.mp4", "--distance-m", "0.1").returncode == 0
    assert (tmp_path / "far.mp4").read_bytes() != (tmp_path / "near.mp4").read_bytes()
    (tmp_path / "000001.npy").unlink()
    for out, options, reason in (
        ("a.mp4", ["--depth-folder", "."], "frame 1 has no depth"),
        ("b.mp4", ["--distance-m", "0"], "--distance-m is 0.0; must be above 0"),
        ("c.mp4", ["--show", "nope"], "--show is 'nope'; `enhance` of the job has nothing"),
        ("far.mp4", [], "far.mp4 exists"),
    ):
        result = convert_video(tmp_path, out, *options)
        assert result.returncode != 0
        assert reason in result.stderr
    assert {path.name for path in tmp_path.glob("*.mp4")} == {"dive.mp4", "far.mp4", "near.mp4"}
    assert not list(tmp_path.glob(".*"))
