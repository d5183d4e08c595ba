"""Counts and times of frames between two reports."""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

NO_DEPTH = "without depth"
NO_CAMERA = "without camera_info"
NO_POSE = "without pose"
BUSY = "replaced by a newer one"
FAILED = "failed"
REASONS = (NO_DEPTH, NO_CAMERA, NO_POSE, BUSY, FAILED)
"""Why pictures are dropped."""
LATE = "late depths"
"""Depths that came after their pictures were dropped without depth."""


@dataclass
class Report:
    """What happened since the report before; `totals` are those since the start."""

    seconds: float
    received: int
    rendered: int
    dropped: dict[str, int]
    late: int
    totals: dict[str, int]
    times_ms: dict[str, tuple[float, float]]
    """Median and maximum of the times of frames by part."""
    problem: str | None
    """Message of the last failed or dropped picture."""


@dataclass
class _Interval:
    counts: Counter[str] = field(default_factory=Counter)
    times_ms: dict[str, list[float]] = field(default_factory=dict)
    problem: str | None = None


class Counts:
    """Counts pictures from several threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._interval = _Interval()
        self._totals: Counter[str] = Counter()

    def receive(self) -> None:
        """Count a picture that arrived."""
        self._count("received")

    def render(self, times_ms: Mapping[str, float]) -> None:
        """Count a rendered picture with the times of its parts."""
        self._count("rendered")
        with self._lock:
            for part, value in times_ms.items():
                self._interval.times_ms.setdefault(part, []).append(value)

    def drop(self, reason: str, problem: str | None = None) -> None:
        """Count a dropped picture."""
        self._count(reason)
        with self._lock:
            self._interval.problem = problem or self._interval.problem

    def add_late_depth(self) -> None:
        """Count a depth that came after its picture was dropped."""
        self._count(LATE)

    def report(self, seconds: float) -> Report:
        """Return the counts of an interval of this length and begin the next one."""
        with self._lock:
            ended, self._interval = self._interval, _Interval()
            totals = {name: self._totals[name] for name in ("received", "rendered", *REASONS, LATE)}
        return Report(
            seconds,
            ended.counts["received"],
            ended.counts["rendered"],
            {reason: ended.counts[reason] for reason in REASONS if ended.counts[reason]},
            ended.counts[LATE],
            totals,
            {part: (float(np.median(values)), max(values)) for part, values in ended.times_ms.items()},
            ended.problem,
        )

    def _count(self, name: str) -> None:
        with self._lock:
            self._interval.counts[name] += 1
            self._totals[name] += 1
