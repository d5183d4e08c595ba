"""Sequences for tests of exports with times, and checks of poses, cameras and depth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import fathom
import numpy as np
from conftest import description
from fathom import _native
from numpy.typing import NDArray
from test_formats import check_sums, fetched, try_export

SIZE = (96, 64)
KINDS = ["rgb", "range", "instances"]
PATH = {"frames": 3, "sway_m": 0.05, "sway_deg": 8.0, "sway_frames": 5}
STAMPS = [1_000_000_000, 1_333_333_333, 1_666_666_667]
SCENE = {"kind": "procedural", "family": "structure", "seed": 3}
BASELINE_M = 0.12


def sequence_job(dataset: str, artifacts: list[str], camera: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """Describe one or more passes along a path at three frames a second."""
    size = {"width": SIZE[0], "height": SIZE[1], "path": PATH, "frames_per_s": 3}
    return description(dataset=dataset, count=3, scene=SCENE, camera=size | camera, artifacts=artifacts) | changes


def render_sequences(server: str) -> str:
    """Render sequences of a pinhole, a lens, a stereo pair and a flat port, and return the service."""
    waters = {"optics": {"grid": ["jerlov-IB", "jerlov-1C"]}}
    barrel = {"distortion": {"k1": -0.1, "p1": 0.01}}
    jobs = [
        sequence_job("dive", KINDS, {}, water=waters, encode={"format": "webp"}),
        sequence_job("lens", ["rgb", "range"], barrel),
        sequence_job("port", ["rgb", "range"], {"port": {"kind": "flat"}}),
        sequence_job("pair", [*KINDS, "rgb_right", "disparity"], {"stereo": {"baseline_m": BASELINE_M}}),
        sequence_job("zoom", ["rgb"], {"hfov_deg": {"uniform": [60, 80]}}),
    ]
    with fathom.Client(server, token="secret") as client:
        for job in jobs:
            assert client.submit(job).wait().state["state"] == "done"
    return server


def export(server: str, tmp_path: Path, dataset: str, format: str, *options: str) -> Path:
    out = tmp_path / f"{dataset}-{format}"
    ended = try_export(server, out, dataset, format, *options)
    assert ended.returncode == 0, ended.stderr
    check_sums(out)
    again = try_export(server, out, dataset, format, *options)
    assert (again.returncode, fetched(again)) == (0, 0), again.stderr
    return out


def decode(bytes: bytes) -> NDArray[Any]:
    return np.asarray(_native.decode(bytes))


def rotation_of(x: float, y: float, z: float, w: float) -> NDArray[np.float64]:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def pose_of(position: Any, quaternion: Any) -> NDArray[np.float64]:
    """Return the matrix from the camera to the world of a position and a quaternion x, y, z, w."""
    world = np.eye(4)
    world[:3, :3], world[:3, 3] = rotation_of(*(float(part) for part in quaternion)), np.array(position, float)
    return world


def distort(x: NDArray[Any], y: NDArray[Any], d: Any) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return distorted coordinates as OpenCV does: k1, k2, p1, p2, k3."""
    k1, k2, p1, p2, k3 = d
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


def share_in_place(one: dict[str, Any], other: dict[str, Any]) -> float:
    """Carry the points of one camera into another; return the share of those in view that are at the depth there.

    A camera has `world` (from its axes right, down, ahead), `k` (3x3, center of the first pixel at 0), `d` as OpenCV,
    and `depth` along the optical axis.
    """
    height, width = one["depth"].shape
    rows, columns = np.mgrid[0:height, 0:width]
    goal_x, goal_y = (columns - one["k"][0, 2]) / one["k"][0, 0], (rows - one["k"][1, 2]) / one["k"][1, 1]
    x, y = goal_x, goal_y
    for _ in range(50):
        there = distort(x, y, one["d"])
        x, y = x - (there[0] - goal_x), y - (there[1] - goal_y)
    valid = one["depth"] > 0
    points = np.stack([x, y, np.ones(x.shape)])[:, valid] * one["depth"][valid]
    world = one["world"][:3, :3] @ points + one["world"][:3, 3:]
    seen = other["world"][:3, :3].T @ (world - other["world"][:3, 3:])
    u, v = distort(seen[0] / seen[2], seen[1] / seen[2], other["d"])
    u, v = u * other["k"][0, 0] + other["k"][0, 2], v * other["k"][1, 1] + other["k"][1, 2]
    column, row = np.rint(u).astype(int), np.rint(v).astype(int)
    inside = (seen[2] > 0) & (column >= 0) & (column < width) & (row >= 0) & (row < height)
    depth = other["depth"][row[inside], column[inside]]
    assert inside.sum() > 0.3 * inside.size
    return float(np.mean(np.abs(depth - seen[2, inside]) < 0.02 * seen[2, inside]))


def check_poses(cameras: list[dict[str, Any]]) -> None:
    """Check that points land on the same surface, and that wrong poses and distances would be noticed."""
    one, other = cameras[:2]
    assert np.linalg.norm(one["world"][:3, 3] - other["world"][:3, 3]) > 0.1
    right = share_in_place(one, other)
    assert right > 0.7
    inverse = [camera | {"world": np.linalg.inv(camera["world"])} for camera in (one, other)]
    assert share_in_place(*inverse) < 0.8 * right
    rows, columns = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    ray = np.hypot(1, np.hypot((columns - one["k"][0, 2]) / one["k"][0, 0], (rows - one["k"][1, 2]) / one["k"][1, 1]))
    ranges = [camera | {"depth": camera["depth"] * ray} for camera in (one, other)]
    assert share_in_place(*ranges) < right - 0.05
