"""Poses of a camera from the transforms of `/tf` and `/tf_static`."""

from __future__ import annotations

import threading
import time
from bisect import bisect_left, insort
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.errors import FathomError
from fathom.messages.poses import interpolate, make_matrix, read_numbers

_KEPT_NS = 10_000_000_000
"""Age of the transforms that are kept, as in tf2."""
_MOST_FRAMES = 64
"""Most transforms from a camera to the world; more are a loop."""

Matrix = NDArray[np.float64]


class NoPose(FathomError):
    """A pose that the received transforms do not give."""


class _Link:
    """The transforms from one frame to its parent, by time."""

    def __init__(self, parent: str) -> None:
        self.parent = parent
        self._stamped: list[tuple[int, tuple[float, ...]]] = []
        self._static: tuple[float, ...] | None = None

    @property
    def stamps(self) -> tuple[int, int]:
        """First and last stamp."""
        return self._stamped[0][0], self._stamped[-1][0]

    def add(self, stamp_ns: int, numbers: tuple[float, ...], *, is_static: bool) -> None:
        if is_static:
            self._static = numbers
            return
        if self._stamped and stamp_ns < self._stamped[-1][0] - _KEPT_NS:
            # The clock of a simulator was reset.
            self._stamped.clear()
        insort(self._stamped, (stamp_ns, numbers))
        oldest = self._stamped[-1][0] - _KEPT_NS
        del self._stamped[: bisect_left(self._stamped, (oldest, ()))]

    def interpolate(self, stamp_ns: int) -> tuple[float, ...] | None:
        """Return translation and quaternion at a time, `None` before the first and after the last transform."""
        if self._static is not None:
            return self._static
        after = bisect_left(self._stamped, (stamp_ns, ()))
        if after < len(self._stamped) and self._stamped[after][0] == stamp_ns:
            return self._stamped[after][1]
        if not 0 < after < len(self._stamped):
            return None
        (begin, first), (end, second) = self._stamped[after - 1 : after + 1]
        return interpolate(first, second, (stamp_ns - begin) / (end - begin))


class Transforms:
    """The tree of frames. Messages are `tf2_msgs/TFMessage`, or anything with the same attributes."""

    def __init__(self) -> None:
        self._links: dict[str, _Link] = {}
        self._changed = threading.Condition()

    def add(self, message: Any) -> None:
        """Take the transforms of a message of `/tf`."""
        with self._changed:
            self._add(message, is_static=False)
            self._changed.notify_all()

    def add_static(self, message: Any) -> None:
        """Take the transforms of a message of `/tf_static`."""
        with self._changed:
            self._add(message, is_static=True)
            self._changed.notify_all()

    def _add(self, message: Any, *, is_static: bool) -> None:
        for stamped in message.transforms:
            child, parent = stamped.child_frame_id.lstrip("/"), stamped.header.frame_id.lstrip("/")
            link = self._links.get(child)
            if link is None or link.parent != parent:
                link = self._links[child] = _Link(parent)
            moved, turned = stamped.transform.translation, stamped.transform.rotation
            numbers = read_numbers(moved, turned)
            stamp = stamped.header.stamp
            link.add(int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec), numbers, is_static=is_static)

    def find_pose(self, frame: str, world: str, stamp_ns: int, wait_s: float = 0.0) -> Matrix:
        """Return the 4×4 matrix from a frame to the world at a time; raises `NoPose` after `wait_s` without it."""
        until = time.monotonic() + wait_s
        with self._changed:
            while True:
                try:
                    return self._find_pose(frame, world, stamp_ns)
                except NoPose:
                    if not self._changed.wait(until - time.monotonic()):
                        raise

    def _find_pose(self, frame: str, world: str, stamp_ns: int) -> Matrix:
        pose: Matrix = np.eye(4)
        current = frame.lstrip("/")
        for _ in range(_MOST_FRAMES):
            if current == world.lstrip("/"):
                return pose
            link = self._links.get(current)
            if link is None:
                raise NoPose(f"/tf has no transform from `{current}` towards `{world}`")
            numbers = link.interpolate(stamp_ns)
            if numbers is None:
                first, last = (f"{stamp / 1e9:.3f}" for stamp in link.stamps)
                raise NoPose(
                    f"/tf has `{current}` from {first} to {last} s, but the picture was taken at {stamp_ns / 1e9:.3f} s"
                )
            pose = make_matrix(numbers) @ pose
            current = link.parent
        raise NoPose(f"/tf has more than {_MOST_FRAMES} transforms from `{frame}` to `{world}`")
