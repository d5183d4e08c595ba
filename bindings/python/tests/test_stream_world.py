"""Snow, patches of turbidity and caustics in the world of a camera that moves, and before one whose pose is unknown."""

from __future__ import annotations

from typing import Any

import fathom
import numpy as np
import pytest
from numpy.typing import NDArray

HEIGHT, WIDTH, FOCAL_PX = 96, 128, 100.0
BOTTOM_M = 3.0
"""Distance of the bottom along the optical axis."""
CAMERA = [[FOCAL_PX, 0, (WIDTH - 1) / 2], [0, FOCAL_PX, (HEIGHT - 1) / 2], [0, 0, 1]]
RGB = np.full((HEIGHT, WIDTH, 3), 150, np.uint8)
Z_DEPTH = np.full((HEIGHT, WIDTH), BOTTOM_M, np.float32)
SUN = {"sun_elevation_deg": 90, "cloud_cover": 0, "wind_m_per_s": 5}
JOBS: dict[str, dict[str, Any]] = {
    "snow": {"water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 3000, "radius_m": 0.002}}},
    "patches": {"water": {"optics": "jerlov-5C", "turbidity": {"contrast": 0.8, "scale_m": 0.5}}},
    "caustics": {
        "scene": {"lighting": "water"},
        "water": {"optics": "jerlov-I", "depth_m": 4},
        "daylight": SUN,
    },
}


def look_down(x_m: float = 0, turned_deg: float = 0) -> NDArray[np.float64]:
    """Return the pose of a camera above the bottom that moved to the right and turned about its axis."""
    cos, sin = np.cos(np.radians(turned_deg)), np.sin(np.radians(turned_deg))
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1, -1, -1]) @ np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    pose[:3, 3] = x_m, 0, 1.5
    return pose


def render(stream: fathom.Stream, pose: NDArray[np.float64] | None, stamp_ns: int = 5) -> NDArray[np.float64]:
    return stream(RGB, z_depth=Z_DEPTH, camera=CAMERA, stamp_ns=stamp_ns, pose=pose).rgb.astype(float)


@pytest.mark.parametrize("effect", JOBS)
def test_effects_keep_their_places_in_the_world_of_poses(effect: str) -> None:
    stream = fathom.Stream(JOBS[effect] | {"seed": 3})
    before = render(stream, look_down())
    turned = render(stream, look_down(turned_deg=180))
    # Light from above, bottom and camera are the same after half a turn: the picture turns with what is in the water.
    assert np.abs(np.rot90(turned, 2) - before).max() <= 1
    assert np.abs(turned - before).mean() > 2
    assert np.abs(render(stream, look_down(x_m=0.3)) - before).mean() > 2
    assert (render(stream, look_down(), stamp_ns=6) == before).all()


@pytest.mark.parametrize("effect", JOBS)
def test_effects_move_with_a_camera_without_a_pose(effect: str) -> None:
    # Without a pose the job has the direction of the sky.
    stream = fathom.Stream(JOBS[effect] | {"seed": 3, "camera": {"up": [0, 0, -1]}})
    before = render(stream, None)
    # They are visible: the bottom alone is the same at both sides of the middle.
    assert np.abs(np.rot90(before, 2) - before).mean() > 2
    assert (render(stream, None, stamp_ns=1_000_000_000) == before).all()


def test_caustics_move_over_the_bottom_as_the_bottom_does() -> None:
    stream = fathom.Stream(JOBS["caustics"] | {"seed": 3})
    moved_px = 10
    before = render(stream, look_down())
    after = render(stream, look_down(x_m=moved_px * BOTTOM_M / FOCAL_PX))
    # The veil and the path to the bottom differ by less than a code in ten pixels; the caustics by tens of codes.
    assert np.abs(after[:, :-moved_px] - before[:, moved_px:]).mean() < 1
    assert np.abs(after - before).mean() > 10
