"""The examples with simulators, with few and small pictures."""

import ctypes.util
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples"
SIZE = WIDTH, HEIGHT = 160, 104
FRAMES = 2


def draw_sheet(name: str, folder: pathlib.Path, **environment: str) -> list[np.ndarray]:
    """Run an example and return the rows of its contact sheet, each (HEIGHT, FRAMES × WIDTH, 3)."""
    sizes = ["--frames", str(FRAMES), "--width", str(WIDTH), "--height", str(HEIGHT)]
    command = [sys.executable, str(EXAMPLES / name), "--out", "sheet.png", *sizes]
    run = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=os.environ | environment)
    assert run.returncode == 0, run.stderr
    lines = [line for line in run.stdout.splitlines() if line.startswith("frame ")]
    assert [line.split(":")[0] for line in lines] == [f"frame {number}" for number in range(FRAMES)]
    sheet = np.asarray(Image.open(folder / "sheet.png").convert("RGB"), float)
    assert sheet.shape[1] == FRAMES * WIDTH
    return np.split(sheet, sheet.shape[0] // HEIGHT)


def check_water(air: np.ndarray, meters: np.ndarray, water: np.ndarray) -> None:
    """Check the rows of pictures, of distances and of water: the water takes away contrast and red light."""
    for row in (air, meters):
        before, after = np.split(row, FRAMES, axis=1)
        assert np.abs(before - after).mean() > 2, "the camera moves"
    assert meters.std() > 10
    assert water.std() < 0.8 * air.std()
    assert water[..., 0].mean() < water[..., 1].mean()


def test_pictures_of_pybullet_are_put_into_water(tmp_path: pathlib.Path) -> None:
    air, meters, water, enhanced = draw_sheet("pybullet_pile.py", tmp_path)
    check_water(air, meters, water)
    assert enhanced.std() > 1.2 * water.std()


def test_pictures_of_mujoco_are_put_into_water(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("mujoco", reason="mujoco is not installed: its example is not tested")
    library = next((name for name in ("OSMesa", "EGL") if ctypes.util.find_library(name)), None)
    if library is None:
        pytest.skip("neither OSMesa nor EGL is installed: the example of MuJoCo is not tested")
    air, meters, water = draw_sheet("mujoco_pile.py", tmp_path, MUJOCO_GL=library.lower())
    check_water(air, meters, water)
