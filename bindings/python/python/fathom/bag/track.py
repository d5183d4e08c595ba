"""A motion, interpolated between its samples."""

from __future__ import annotations

from bisect import bisect_left
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.bag.errors import BagError
from fathom.errors import FathomError
from fathom.messages.poses import Numbers, interpolate, make_matrix, read_numbers

MAX_GAP_NS = 1_000_000_000
"""Longest time between two samples that is interpolated."""
MAX_BEYOND_NS = 20_000_000
"""Longest time before the first sample or after the last one."""
_LENGTH_TOLERANCE = 0.01
"""Largest difference of the length of a quaternion from 1."""


class NoPose(FathomError, ValueError):
    """No pose at a time."""


class Track:
    """Positions and orientations by time."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._samples: dict[int, Numbers] = {}
        self._stamps: list[int] = []

    def add(self, stamp_ns: int, position: Any, orientation: Any) -> None:
        """Add a sample; `position` has x, y and z, `orientation` also w. Raises `BagError`."""
        numbers = read_numbers(position, orientation)
        if not np.isfinite(numbers).all() or abs(float(np.linalg.norm(numbers[3:])) - 1) > _LENGTH_TOLERANCE:
            values = ", ".join(f"{value:g}" for value in numbers)
            raise BagError(
                f"{self._name}: the pose [{values}] must have a finite position and a quaternion of length 1"
            )
        self._samples[stamp_ns] = numbers
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
            return make_matrix(self._samples[nearest])
        if not near or near[1] - near[0] > MAX_GAP_NS or not near[0] <= stamp_ns <= near[1]:
            self._refuse(stamp_ns, min(near, key=lambda stamp: abs(stamp - stamp_ns), default=None))
        share = (stamp_ns - near[0]) / (near[1] - near[0])
        return make_matrix(interpolate(self._samples[near[0]], self._samples[near[1]], share))

    def _refuse(self, stamp_ns: int, nearest_ns: int | None) -> None:
        if nearest_ns is None:
            raise NoPose(f"{self._name} has no pose")
        seconds = abs(nearest_ns - stamp_ns) / 1e9
        raise NoPose(f"{self._name}: the nearest pose is {seconds:g} s away, too far to interpolate")
