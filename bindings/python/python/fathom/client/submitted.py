"""Jobs of a service, of both clients."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fathom.client import calls, deletion
from fathom.client.rows import Rows
from fathom.client.state import JobState
from fathom.errors import JobTimeout

if TYPE_CHECKING:
    from fathom.client.aio import AsyncClient
    from fathom.client.sync import Client


class Submitted(JobState):
    """A job of a service."""

    def __init__(self, client: Client, state: dict[str, Any]) -> None:
        super().__init__(state)
        self._client = client

    def wait(self, *, timeout: float | None = None, progress: bool = True) -> Submitted:
        """Wait until it has ended, with a progress bar on a terminal.

        After `timeout` seconds, rounded up by less than one, raises `fathom.JobTimeout`, a `TimeoutError`; the job
        continues.
        """
        try:
            self.state = self._client._run(calls.wait(self.state, progress, timeout))
        except JobTimeout as late:
            self.state = late.state
            raise
        return self

    def cancel(self) -> Submitted:
        """Cancel it; its images stay."""
        self.state = self._client._run(calls.control(self.id, "cancel"))
        return self

    def pause(self) -> Submitted:
        """Pause it; frames being rendered are finished."""
        self.state = self._client._run(calls.control(self.id, "pause"))
        return self

    def resume(self) -> Submitted:
        """Resume it after a pause."""
        self.state = self._client._run(calls.control(self.id, "resume"))
        return self

    def retry(self) -> Submitted:
        """Try its failed frames again."""
        self.state = self._client._run(calls.control(self.id, "retry-failed"))
        return self

    def finish_elsewhere(self) -> Submitted:
        """Let workers of any version and kind of machine finish it; images state their origin."""
        self.state = self._client._run(calls.control(self.id, "finish-elsewhere"))
        return self

    def start_again(self) -> Submitted:
        """Remove its images and render it from the beginning."""
        self.state = self._client._run(calls.control(self.id, "start-again"))
        return self

    def delete(self) -> dict[str, Any]:
        """Delete it with its images, and return the numbers of deleted `jobs`, `images` and `bytes`."""
        return self._client._run(deletion.delete(self.id))

    def errors(self) -> Rows:
        """Return its failed frames, a row each."""
        return self._client._run(calls.errors(self.id))

    def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return self._client._run(calls.frame_warnings(self.id))


class AsyncSubmitted(JobState):
    """A job of a service."""

    def __init__(self, client: AsyncClient, state: dict[str, Any]) -> None:
        super().__init__(state)
        self._client = client

    async def wait(self, *, timeout: float | None = None, progress: bool = True) -> AsyncSubmitted:
        """Wait until it has ended. After `timeout` seconds raises `fathom.JobTimeout`; the job continues."""
        try:
            self.state = await self._client._run(calls.wait(self.state, progress, timeout))
        except JobTimeout as late:
            self.state = late.state
            raise
        return self

    async def cancel(self) -> AsyncSubmitted:
        """Cancel it; its images stay."""
        self.state = await self._client._run(calls.control(self.id, "cancel"))
        return self

    async def pause(self) -> AsyncSubmitted:
        """Pause it; frames being rendered are finished."""
        self.state = await self._client._run(calls.control(self.id, "pause"))
        return self

    async def resume(self) -> AsyncSubmitted:
        """Resume it after a pause."""
        self.state = await self._client._run(calls.control(self.id, "resume"))
        return self

    async def retry(self) -> AsyncSubmitted:
        """Try its failed frames again."""
        self.state = await self._client._run(calls.control(self.id, "retry-failed"))
        return self

    async def finish_elsewhere(self) -> AsyncSubmitted:
        """Let workers of any version and kind of machine finish it; images state their origin."""
        self.state = await self._client._run(calls.control(self.id, "finish-elsewhere"))
        return self

    async def start_again(self) -> AsyncSubmitted:
        """Remove its images and render it from the beginning."""
        self.state = await self._client._run(calls.control(self.id, "start-again"))
        return self

    async def delete(self) -> dict[str, Any]:
        """Delete it with its images, and return the numbers of deleted `jobs`, `images` and `bytes`."""
        return await self._client._run(deletion.delete(self.id))

    async def errors(self) -> Rows:
        """Return its failed frames, a row each."""
        return await self._client._run(calls.errors(self.id))

    async def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return await self._client._run(calls.frame_warnings(self.id))
