"""Inspects a pile in PyBullet and puts the pictures into water: a contact sheet of air, distances, water and enhancement.

Needs the package `fathom`, pybullet and pillow. Renders on the CPU, without a window:

    python examples/pybullet_pile.py --out pile.webp
"""

import argparse
import math
import pathlib
import tempfile
from dataclasses import dataclass

import fathom
import numpy as np
import pybullet
from PIL import Image

JOB = {
    "water": {
        "optics": {
            "preset": "jerlov-1C",
            "veiling_light": [0.04, 0.15, 0.14],
            "forward_scatter": {"model": "jaffe"},
        },
        "range_scale": 0.5,
        "snow": {"density_per_m3": 2000, "radius_m": 0.0005},
    },
    "lights": [
        {"kind": "haze", "x": 0.2, "y": 1.05, "size": 0.2, "intensity": 0.2, "color": [0.7, 1, 0.9]},
        {"kind": "haze", "x": 0.8, "y": 1.05, "size": 0.2, "intensity": 0.2, "color": [0.7, 1, 0.9]},
    ],
    "enhance": ["hscm"],
}
HFOV_DEG = 75
NEAR_M, FAR_M = 0.1, 30


@dataclass
class Shot:
    """A picture of the simulator: sRGB codes, meters along the optical axis, and the pose of the camera."""

    rgb: np.ndarray
    z_depth: np.ndarray
    pose: np.ndarray


def make_texture(folder: pathlib.Path, name: str, dark: tuple, light: tuple, seed: int) -> int:
    """Load a texture of blotches of several sizes between two colors."""
    rng, side = np.random.default_rng(seed), 512
    noise = np.zeros((side, side))
    for cells in (8, 32, 128, 512):
        grain = Image.fromarray(rng.random((cells, cells)).astype(np.float32))
        noise += np.asarray(grain.resize((side, side), Image.Resampling.BICUBIC)) / cells**0.4
    share = ((noise - noise.min()) / np.ptp(noise))[..., None]
    path = folder / f"{name}.png"
    Image.fromarray(np.uint8(np.array(dark) * (1 - share) + np.array(light) * share)).save(path)
    return pybullet.loadTexture(str(path))


def place(shape: int, position: tuple, texture: int, turn: tuple = (0, 0, 0), **size: object) -> None:
    """Put a textured body into the world."""
    visual = pybullet.createVisualShape(shape, **size)
    turned = pybullet.getQuaternionFromEuler(turn)
    body = pybullet.createMultiBody(0, -1, visual, position, turned)
    pybullet.changeVisualShape(body, -1, textureUniqueId=texture, rgbaColor=(1, 1, 1, 1))


def build_site(folder: pathlib.Path) -> None:
    """Build a pile with mussels, an anode and a clamp on a bottom with stones."""
    steel = make_texture(folder, "steel", (70, 55, 45), (175, 150, 120), 1)
    shell = make_texture(folder, "shell", (25, 25, 35), (120, 115, 110), 2)
    sand = make_texture(folder, "sand", (105, 95, 75), (190, 175, 145), 3)
    zinc = make_texture(folder, "zinc", (150, 150, 150), (230, 230, 225), 4)
    place(pybullet.GEOM_BOX, (0, 0, -0.05), sand, halfExtents=(12, 12, 0.05))
    place(pybullet.GEOM_CYLINDER, (0, 0, 2.5), steel, radius=0.4, length=5)
    place(pybullet.GEOM_CYLINDER, (2.6, 2.2, 2.5), steel, radius=0.4, length=5)
    place(pybullet.GEOM_CYLINDER, (0, 0, 1.55), zinc, radius=0.44, length=0.12)
    place(pybullet.GEOM_BOX, (0.1, -0.47, 0.95), zinc, halfExtents=(0.06, 0.06, 0.28))
    rng = np.random.default_rng(5)
    for _ in range(90):
        angle, height = rng.uniform(0, math.tau), 2.6 - rng.exponential(0.35)
        center = (0.41 * math.cos(angle), 0.41 * math.sin(angle), height)
        place(pybullet.GEOM_SPHERE, center, shell, radius=rng.uniform(0.03, 0.08))
    for _ in range(40):
        x, y = rng.uniform(-3, 3), rng.uniform(-1.2, 3)
        place(pybullet.GEOM_SPHERE, (x, y, 0), shell, radius=rng.uniform(0.04, 0.16))


def make_camera(size: tuple[int, int]) -> np.ndarray:
    """Return the matrix of the camera in pixels."""
    width, height = size
    focal = width / 2 / math.tan(math.radians(HFOV_DEG) / 2)
    return np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])


def take_shot(share: float, size: tuple[int, int]) -> Shot:
    """Take the picture after a share, 0 to 1, of the way past the pile."""
    width, height = size
    eye = np.array([-1.3 + 2.6 * share, -2.0 - 0.3 * math.sin(math.pi * share), 1.9 - 0.7 * share])
    target = np.array([0.25 * (share - 0.5), 0, eye[2] - 0.25])
    view = pybullet.computeViewMatrix(eye.tolist(), target.tolist(), (0, 0, 1))
    vfov_deg = math.degrees(2 * math.atan(math.tan(math.radians(HFOV_DEG) / 2) * height / width))
    projection = pybullet.computeProjectionMatrixFOV(vfov_deg, width / height, NEAR_M, FAR_M)
    _, _, rgba, buffer, _ = pybullet.getCameraImage(
        width,
        height,
        view,
        projection,
        lightDirection=(-2, -4, 6),
        shadow=1,
        renderer=pybullet.ER_TINY_RENDERER,
    )
    rgb = np.reshape(np.asarray(rgba, np.uint8), (height, width, 4))[:, :, :3]
    codes = np.reshape(np.asarray(buffer, np.float32), (height, width))
    z_depth = FAR_M * NEAR_M / (FAR_M - (FAR_M - NEAR_M) * codes)
    z_depth[codes >= 1] = np.inf
    # The view matrix looks along -z with y up; a camera of Fathom looks along z with y down.
    to_world = np.linalg.inv(np.reshape(view, (4, 4)).T) @ np.diag([1, -1, -1, 1])
    return Shot(rgb, z_depth, to_world)


def color_depth(z_depth: np.ndarray) -> np.ndarray:
    """Return near as white, far as dark blue, and no return as black."""
    share = np.clip(1 - (z_depth - 0.5) / 5, 0, 1)[..., None] * np.isfinite(z_depth)[..., None]
    return np.uint8(255 * share ** np.array([1.6, 1.2, 0.8]))


def main() -> None:
    """Drive past the pile and write the contact sheet."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default="pybullet_pile.webp")
    parser.add_argument("--frames", type=int, default=4, help="pictures on the way past the pile")
    parser.add_argument("--width", type=int, default=768)
    parser.add_argument("--height", type=int, default=492)
    given = parser.parse_args()
    size = given.width, given.height
    pybullet.connect(pybullet.DIRECT)
    with tempfile.TemporaryDirectory() as folder:
        build_site(pathlib.Path(folder))
        stream = fathom.Stream(JOB)
        columns = []
        for number in range(given.frames):
            shot = take_shot(number / max(given.frames - 1, 1), size)
            out = stream(
                shot.rgb,
                z_depth=shot.z_depth.astype(np.float32),
                camera=make_camera(size),
                stamp_ns=number * 100_000_000,
                pose=shot.pose,
            )
            print(f"frame {number}: {out.elapsed_ms:.0f} ms")
            columns.append(np.concatenate([shot.rgb, color_depth(shot.z_depth), out.rgb, out.enhanced["hscm"]]))
    pybullet.disconnect()
    sheet = Image.fromarray(np.concatenate(columns, axis=1))
    sheet.thumbnail((1600, 1600))
    sheet.save(given.out, quality=80)


if __name__ == "__main__":
    main()
