"""Endless data for torch without storage."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from torch.utils.data import IterableDataset, get_worker_info

from fathom.arguments import list_kinds
from fathom.frame import Artifact
from fathom.job import Job


class Endless(IterableDataset):
    """The frames of a job for ever, each as a dictionary of arrays by kind. Worker w of W takes i ≡ w (mod W).

    The `count` of the job does not matter: after the last of its frames come those that a larger count would add. Its
    state is one integer, the number of frames that this worker has taken.
    """

    def __init__(self, job: Job, kinds: Sequence[str] | None = None) -> None:
        super().__init__()
        self.job = job.endless()
        self.kinds = list_kinds(kinds)
        self.taken = 0

    def __iter__(self) -> Iterator[dict[str, Artifact]]:
        info = get_worker_info()
        worker, workers = (0, 1) if info is None else (info.id, info.num_workers)
        while True:
            index = (worker + self.taken * workers) % len(self.job)
            # Counted before it is handed over: who saves the state meanwhile has the frame.
            self.taken += 1
            yield self.job.read(index, self.kinds).artifacts

    def state_dict(self) -> dict[str, int]:
        """Return the number of frames taken."""
        return {"taken": self.taken}

    def load_state_dict(self, state: dict[str, int]) -> None:
        """Continue after the consumed frames."""
        self.taken = state["taken"]
