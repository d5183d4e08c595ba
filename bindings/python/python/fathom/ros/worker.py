"""A thread that works on the newest item: items that wait while it is busy replace each other."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class NewestWorker(Generic[Item]):
    """Calls `work` with one item after another in a thread of its own, always with the newest one."""

    def __init__(self, work: Callable[[Item], None]) -> None:
        self._work = work
        self._waiting: Item | None = None
        self._is_stopped = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="fathom-frames", daemon=True)
        self._thread.start()

    def submit(self, item: Item) -> bool:
        """Put an item in line; returns whether it replaced one."""
        with self._changed:
            replaced = self._waiting is not None
            self._waiting = item
            self._changed.notify()
        return replaced

    def stop(self) -> None:
        """End the thread after the item at hand."""
        with self._changed:
            self._is_stopped = True
            self._changed.notify()
        self._thread.join()

    def _run(self) -> None:
        while True:
            with self._changed:
                while self._waiting is None and not self._is_stopped:
                    self._changed.wait()
                item, self._waiting = self._waiting, None
                if self._is_stopped or item is None:
                    return
            self._work(item)
