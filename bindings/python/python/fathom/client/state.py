"""State of a job, shared by the jobs of both clients."""

from __future__ import annotations

from typing import Any

from fathom.display import html_table


class JobState:
    """A job of a service with its latest known state."""

    def __init__(self, state: dict[str, Any]) -> None:
        self.state = state
        """Latest state from the service: `id`, `dataset`, `state`, `frames`, `done`, `failed`, `unproven`, `digest`."""

    @property
    def id(self) -> str:
        """Its id."""
        return str(self.state["id"])

    def __repr__(self) -> str:
        return f"<fathom.{type(self).__name__} {self.id}: {self.state['dataset']}, {self._describe_progress()}>"

    def _repr_html_(self) -> str:
        shown = ("dataset", "created_at", "finished_at", "digest")
        rows = {"state": self._describe_progress()} | {name: self.state.get(name) for name in shown}
        return html_table(f"Job {self.id}", rows)

    def _describe_progress(self) -> str:
        failed = f", {self.state['failed']} failed" if self.state["failed"] else ""
        unproven = f", {self.state['unproven']} unproven" if self.state.get("unproven") else ""
        return f"{self.state['state']}, {self.state['done']} of {self.state['frames']} frames{failed}{unproven}"
