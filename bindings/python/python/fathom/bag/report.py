"""Diagnostics of frames: each one while it is new, and all of them counted at the end."""

from __future__ import annotations

import sys
import time
from collections import Counter

_SHOWN = 3
"""Diagnostics of a kind that are printed before the end."""
_TERMINAL_S, _FILE_S = 0.2, 10.0
"""Time between two lines of progress, on a terminal and elsewhere."""


class Report:
    """Counts frames, and prints progress and diagnostics on standard error."""

    def __init__(self, noun: str = "frame") -> None:
        """`noun` is the name of what is counted."""
        self._noun = noun
        self.done = 0
        """Frames that were written."""
        self._left_out: Counter[str] = Counter()
        self._warned: Counter[str] = Counter()
        self._started = self._drawn = time.monotonic()
        self._is_terminal = sys.stderr.isatty()

    @property
    def left_out(self) -> int:
        """Frames that were not written."""
        return sum(self._left_out.values())

    def leave_out(self, stamp_ns: int, kind: str, reason: str) -> None:
        """Count a frame that has no result. `kind` is the reason without numbers."""
        self._count(self._left_out, stamp_ns, kind, f"left out: {reason}")

    def warn(self, stamp_ns: int, kind: str, reason: str | None = None) -> None:
        """Count a warning about a frame that has a result."""
        self._count(self._warned, stamp_ns, kind, reason or kind)

    def note(self, text: str) -> None:
        """Print a line."""
        self._print(text)

    def advance(self) -> None:
        """Count a frame that was written, and show the progress now and then."""
        self.done += 1
        now = time.monotonic()
        if now - self._drawn < (_TERMINAL_S if self._is_terminal else _FILE_S):
            return
        self._drawn = now
        rate = self.done / (now - self._started)
        line = f"{self.done} {self._noun}s, {self.left_out} left out, {rate:.1f} {self._noun}s/s"
        print(f"\r\033[K{line}" if self._is_terminal else line, end="" if self._is_terminal else "\n", file=sys.stderr)
        sys.stderr.flush()

    def summarize(self) -> None:
        """Print the counts of everything."""
        rate = self.done / max(time.monotonic() - self._started, 1e-9)
        noun = self._noun if self.done == 1 else f"{self._noun}s"
        self._print(f"{self.done} {noun} written, {self.left_out} left out, {rate:.1f} {self._noun}s/s")
        for title, counts in (("left out", self._left_out), ("warning", self._warned)):
            for kind, count in counts.most_common():
                self._print(f"  {title}: {count} × {kind}")

    def _count(self, counts: Counter[str], stamp_ns: int, kind: str, text: str) -> None:
        counts[kind] += 1
        if counts[kind] <= _SHOWN:
            more = "; more like it are counted" if counts[kind] == _SHOWN else ""
            self._print(f"{self._noun} {format_stamp(stamp_ns)}: {text}{more}")

    def _print(self, text: str) -> None:
        print(f"\r\033[K{text}" if self._is_terminal else text, file=sys.stderr)


def format_stamp(stamp_ns: int) -> str:
    """Return a time in seconds with all digits."""
    return f"{stamp_ns // 1_000_000_000}.{stamp_ns % 1_000_000_000:09d}"
