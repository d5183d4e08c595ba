from __future__ import annotations

import math
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

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
