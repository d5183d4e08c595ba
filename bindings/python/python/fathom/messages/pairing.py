"""Pairs images with depths by their stamps, in the order of the images.

The depth of an image is that with the nearest stamp, the same stamp first of all, at most `slop_ns` away; of two that
are as near, the earlier one. A depth may serve several images. An image is decided as soon as no later depth can be
nearer: a depth with its stamp or a later one is there. The pairs of two topics whose stamps ascend therefore depend on
the stamps alone, not on the order of arrival, and a recording and a live camera have the same.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

Image = TypeVar("Image")
Depth = TypeVar("Depth")

SLOP_NS = 20_000_000
"""Largest difference of the stamps of a pair, by default."""
WAIT_NS = 1_000_000_000
"""Lag of a topic after which the other one does not wait for it, by default."""
_MOST_WAITING = 128
"""Limit of the memory if stamps do not advance."""


@dataclass(frozen=True)
class Pair(Generic[Image, Depth]):
    """An image with its depth."""

    stamp_ns: int
    image: Image
    depth: Depth | None
    """`None` if no depth is near enough."""
    offset_ns: int | None
    """Stamp of the nearest depth minus that of the image, also of one that is too far; `None` without any."""


class Pairing(Generic[Image, Depth]):
    """Takes images and depths as they arrive and returns the pairs that they complete.

    `wait_ns`: an image is returned without depth once a later image is that much newer. A message that is older than
    the newest one of its topic by more than that restarts the pairing: the clock of a simulator was reset.
    """

    def __init__(self, slop_ns: int = SLOP_NS, wait_ns: int = WAIT_NS) -> None:
        self._slop_ns = slop_ns
        self._wait_ns = max(wait_ns, slop_ns)
        self._images: deque[tuple[int, Image]] = deque()
        self._stamps: list[int] = []
        self._depths: dict[int, Depth] = {}
        self._used: set[int] = set()
        self._newest_image: int | None = None
        self._given_up: deque[int] = deque(maxlen=_MOST_WAITING)
        self.unused_depths = 0
        """Number of depths that were dropped without an image."""
        self.late_depths = 0
        """Number of images that were returned without depth and whose depth came afterwards."""

    @property
    def waiting(self) -> int:
        """Number of images that wait for a depth."""
        return len(self._images)

    def add_image(self, stamp_ns: int, image: Image) -> list[Pair[Image, Depth]]:
        """Take an image and return the pairs that are complete, oldest first."""
        restarted = self._restart_if_older(stamp_ns, self._newest_image)
        self._images.append((stamp_ns, image))
        self._newest_image = max(stamp_ns, self._newest_image or 0)
        return restarted + self._take_decided()

    def add_depth(self, stamp_ns: int, depth: Depth) -> list[Pair[Image, Depth]]:
        """Take a depth and return the pairs that it completes, oldest first."""
        if stamp_ns in self._depths:
            # Of depths with one stamp, the first holds, whether its image came before or after the second.
            self.unused_depths += 1
            return []
        restarted = self._restart_if_older(stamp_ns, self._stamps[-1] if self._stamps else None)
        self._count_late_depth(stamp_ns)
        insort(self._stamps, stamp_ns)
        self._depths[stamp_ns] = depth
        return restarted + self._take_decided()

    def flush(self) -> list[Pair[Image, Depth]]:
        """Return all waiting images, with the depths there are, and forget the depths."""
        pairs = [self._match(*image) for image in self._images]
        self._images.clear()
        self._given_up.clear()
        self._drop_depths(len(self._stamps))
        self._newest_image = None
        return pairs

    def _restart_if_older(self, stamp_ns: int, newest_ns: int | None) -> list[Pair[Image, Depth]]:
        return self.flush() if newest_ns is not None and stamp_ns < newest_ns - self._wait_ns else []

    def _take_decided(self) -> list[Pair[Image, Depth]]:
        pairs = []
        while self._images and self._is_decided(self._images[0][0]):
            pair = self._match(*self._images.popleft())
            if pair.depth is None:
                self._given_up.append(pair.stamp_ns)
            pairs.append(pair)
        self._drop_depths(self._count_old_depths())
        return pairs

    def _is_decided(self, stamp_ns: int) -> bool:
        if len(self._images) > _MOST_WAITING:
            return True
        if self._stamps and self._stamps[-1] >= stamp_ns:
            return True
        return self._newest_image is not None and self._newest_image > stamp_ns + self._wait_ns

    def _match(self, stamp_ns: int, image: Image) -> Pair[Image, Depth]:
        after = bisect_left(self._stamps, stamp_ns)
        offsets = [stamp - stamp_ns for stamp in self._stamps[max(after - 1, 0) : after + 1]]
        if not offsets:
            return Pair(stamp_ns, image, None, None)
        offset = min(offsets, key=abs)
        if abs(offset) > self._slop_ns:
            return Pair(stamp_ns, image, None, offset)
        self._used.add(stamp_ns + offset)
        return Pair(stamp_ns, image, self._depths[stamp_ns + offset], offset)

    def _count_late_depth(self, stamp_ns: int) -> None:
        # A depth that was there in time would have been paired, so one within the slop is late.
        nearest = min(self._given_up, key=lambda given_up: abs(given_up - stamp_ns), default=None)
        if nearest is not None and abs(nearest - stamp_ns) <= self._slop_ns:
            self._given_up.remove(nearest)
            self.late_depths += 1

    def _count_old_depths(self) -> int:
        """Return the number of depths that no image, waiting or to come, can have."""
        if not self._stamps:
            return 0
        # One depth before the oldest image stays, for the offset of an image without a depth.
        oldest = self._stamps[-1] - self._wait_ns
        if self._newest_image is not None:
            oldest = max(oldest, self._newest_image - self._slop_ns)
        if self._images:
            oldest = min(self._images[0][0] - self._slop_ns, oldest)
        return max(bisect_left(self._stamps, oldest) - 1, 0)

    def _drop_depths(self, count: int) -> None:
        for stamp in self._stamps[:count]:
            del self._depths[stamp]
            if stamp in self._used:
                self._used.discard(stamp)
            else:
                self.unused_depths += 1
        del self._stamps[:count]
