"""A progress bar on terminals only."""

from __future__ import annotations

import sys

WIDTH = 40


class Progress:
    """A bar redrawn in place; `shown=False` hides it."""

    def __init__(self, what: str, total: int, shown: bool) -> None:
        self.what, self.total = what, max(total, 1)
        self.shown = shown and sys.stderr.isatty()

    def set(self, done: int) -> None:
        """Draw how much is done."""
        if self.shown:
            full = WIDTH * done // self.total
            bar = "#" * full + "-" * (WIDTH - full)
            end = "\n" if done >= self.total else ""
            print(f"\r{self.what} [{bar}] {done}/{self.total}", end=end, file=sys.stderr, flush=True)
