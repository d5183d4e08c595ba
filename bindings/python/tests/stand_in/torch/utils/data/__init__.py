"""As much of torch's interface as `fathom.torch` uses."""

from __future__ import annotations

from dataclasses import dataclass


class IterableDataset:
    """A dataset that is iterated in every worker."""


@dataclass
class WorkerInfo:
    """Which of how many workers this process is."""

    id: int
    num_workers: int


_info: WorkerInfo | None = None


def get_worker_info() -> WorkerInfo | None:
    """Return what this process is; `None` in the main one."""
    return _info


def begin_worker(worker: int, workers: int) -> None:
    """Make this process a worker."""
    global _info
    _info = WorkerInfo(worker, workers)
