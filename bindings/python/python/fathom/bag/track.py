"""A motion, interpolated between its samples."""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.bag.errors import BagError
from fathom.errors import FathomError

MAX_GAP_NS = 1_000_000_000
"""Longest time between two samples that is interpolated."""
MAX_BEYOND_NS = 20_000_000
"""Longest time before the first sample or after the last one."""


class NoPose(FathomError, ValueError):
    """No pose at a time."""


class Track:
    """Positions and orientations by time."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._samples: dict[int, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
        self._stamps: list[int] = []

    def add(self, stamp_ns: int, position: Any, orientation: Any) -> None:
        """Add a sample; `position` has x, y and z, `orientation` also w. Raises `BagError`."""
        place = np.array([position.x, position.y, position.z], dtype=np.float64)
        turn = np.array([orientation.x, orientation.y, orientation.z, orientation.w], dtype=np.float64)
        length = float(np.linalg.norm(turn))
        if not np.isfinite(place).all() or not abs(length - 1) < 0.01:
            values = ", ".join(f"{value:g}" for value in [*place, *turn])
            raise BagError(
                f"{self._name}: the pose [{values}] must have a finite position and a quaternion of length 1"
            )
        self._samples[stamp_ns] = (place, turn / length)
        self._stamps.clear()

    def interpolate(self, stamp_ns: int) -> NDArray[np.float64]:
        """Return the matrix at a time; raises `NoPose`."""
        if not self._stamps:
            self._stamps = sorted(self._samples)
        after = bisect_left(self._stamps, stamp_ns)
        near = self._stamps[max(after - 1, 0) : after + 1]
        exact = [stamp for stamp in near if stamp == stamp_ns]
        if exact or len(near) == 1:
            nearest = (exact or near)[0]
            if abs(nearest - stamp_ns) > MAX_BEYOND_NS:
                self._refuse(stamp_ns, nearest)
            return _compose(*self._samples[nearest])
        if not near or near[1] - near[0] > MAX_GAP_NS or not near[0] <= stamp_ns <= near[1]:
            self._refuse(stamp_ns, min(near, key=lambda stamp: abs(stamp - stamp_ns), default=None))
        share = (stamp_ns - near[0]) / (near[1] - near[0])
        (start, from_turn), (end, to_turn) = self._samples[near[0]], self._samples[near[1]]
        return _compose(start + share * (end - start), _turn_between(from_turn, to_turn, share))

    def _refuse(self, stamp_ns: int, nearest_ns: int | None) -> None:
        if nearest_ns is None:
            raise NoPose(f"{self._name} has no pose")
        seconds = abs(nearest_ns - stamp_ns) / 1e9
        raise NoPose(f"{self._name}: the nearest pose is {seconds:g} s away, too far to interpolate")


def make_matrix(position: Any, orientation: Any) -> NDArray[np.float64]:
    """Return the matrix of a position with x, y and z, and a quaternion with x, y, z and w."""
    track = Track("a fixed transform")
    track.add(0, position, orientation)
    return track.interpolate(0)


def _turn_between(start: NDArray[np.float64], end: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Return the quaternion on the shorter arc between two (slerp)."""
    cosine = float(start @ end)
    if cosine < 0:
        end, cosine = -end, -cosine
    if cosine > 1 - 1e-9:
        return start
    angle = np.arccos(cosine)
    turn: NDArray[np.float64] = (np.sin((1 - share) * angle) * start + np.sin(share * angle) * end) / np.sin(angle)
    return turn


def _compose(place: NDArray[np.float64], turn: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y, z, w = turn
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = place
    return matrix
