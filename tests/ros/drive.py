"""Pictures of a drive past a pile, rendered once by PyBullet and played as often as a test needs."""

import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "examples"))

import pybullet
import pybullet_pile as pile

SMALL = 160, 120


def render_drive(size: tuple[int, int], count: int) -> list[pile.Shot]:
    """Return the pictures of one way past the pile."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        with tempfile.TemporaryDirectory() as folder:
            pile.build_site(pathlib.Path(folder))
            shots = [pile.take_shot(number / max(count - 1, 1), size) for number in range(count)]
    finally:
        pybullet.disconnect(client)
    return [pile.Shot(np.ascontiguousarray(shot.rgb), shot.z_depth.astype(np.float32), shot.pose) for shot in shots]
