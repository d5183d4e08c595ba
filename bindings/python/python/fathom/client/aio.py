"""The client for asyncio."""

from __future__ import annotations

import asyncio
import os
import warnings
import weakref
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import httpx

from fathom.arguments import list_kinds
from fathom.client import calls, deletion, exports, imports
from fathom.client.aio_scene_methods import AsyncSceneMethods
from fathom.client.calls import Description
from fathom.client.connection import Attempts, Connection
from fathom.client.dataset import Dataset
from fathom.client.known import find_job
from fathom.client.loops import LoopClients
from fathom.client.protocol import Call, Request
from fathom.client.rows import Rows
from fathom.client.submitted import AsyncSubmitted
from fathom.display import html_table
from fathom.errors import FathomError
from fathom.frame import Frame

T = TypeVar("T")


class AsyncClient(AsyncSceneMethods):
    """A connection to a service; see `Client`, whose methods it has."""

    def __init__(self, server: str | None = None, *, token: str | None = None) -> None:
        """Defaults: FATHOM_SERVER and FATHOM_TOKEN. Raises `FathomError` for an address or proxy that is no URL."""
        self._connection = Connection(server, token)
        self.server, self.token = self._connection.server, self._connection.token
        self._clients = LoopClients(self._connection)
        weakref.finalize(self, self._clients.release)

    def __repr__(self) -> str:
        return f"<fathom.AsyncClient {self._connection.name}>"

    def _repr_html_(self) -> str:
        return html_table("Fathom client", {"server": self._connection.name, "token": "set" if self.token else "none"})

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Close all connections."""
        await self._clients.close()

    async def _run(self, call: Call[T]) -> T:
        try:
            request = next(call)
            while True:
                try:
                    response = await self._send(request)
                except FathomError as error:
                    request = call.throw(error)
                else:
                    request = call.send(response)
        except StopIteration as end:
            value: T = end.value
            return value

    async def _send(self, request: Request) -> httpx.Response:
        http = await self._clients.open()
        attempts = Attempts(request.patience_s)
        while True:
            try:
                response = await http.request(request.method, request.path, **request.options)
            except httpx.RequestError as error:
                raise self._connection.unreachable(error) from error
            pause = attempts.pause_s(response)
            if pause is None:
                return self._connection.check(response)
            await asyncio.sleep(pause)

    async def submit(self, description: Description, *, key: str | None = None, again: bool = False) -> AsyncSubmitted:
        """Submit a job. Warnings of the service are warnings of Python."""
        submitted = AsyncSubmitted(self, await self._run(calls.submit(description, key, again)))
        for warning in submitted.state.get("warnings") or ():
            warnings.warn(warning, stacklevel=2)
        return submitted

    async def dry_run(self, description: Description, *, frames: int = 0) -> dict[str, Any]:
        """Check a job as `submit` does, without submitting it, and return its price."""
        return await self._run(calls.dry_run(description, frames))

    async def jobs(
        self, *, dataset: str | None = None, state: str | None = None, limit: int | None = None
    ) -> list[AsyncSubmitted]:
        """Return the jobs of the service, the newest first."""
        return [AsyncSubmitted(self, row) for row in await self._run(calls.jobs(dataset, state, limit))]

    async def job(self, id: str) -> AsyncSubmitted:
        """Return a job by its id or the unique start of it."""
        return AsyncSubmitted(self, await self._run(find_job(id)))

    async def cancel(self, id: str) -> AsyncSubmitted:
        """Cancel a job and return it; its images stay."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "cancel")))

    async def pause(self, id: str) -> AsyncSubmitted:
        """Pause a job and return it; frames being rendered are finished."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "pause")))

    async def resume(self, id: str) -> AsyncSubmitted:
        """Resume a paused job and return it."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "resume")))

    async def retry(self, id: str) -> AsyncSubmitted:
        """Try the failed frames of a job again and return it."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "retry-failed")))

    async def finish_elsewhere(self, id: str) -> AsyncSubmitted:
        """Let workers of any version and kind of machine finish a job; images state their origin."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "finish-elsewhere")))

    async def start_again(self, id: str) -> AsyncSubmitted:
        """Remove the images of a job and render it from the beginning."""
        return AsyncSubmitted(self, await self._run(calls.control(id, "start-again")))

    async def errors(self, id: str) -> Rows:
        """Return the failed frames of a job, a row each."""
        return await self._run(calls.errors(id))

    async def datasets(self) -> Rows:
        """Return the datasets of the service: `name`, `images`, `bytes`, `jobs`."""
        return await self._run(calls.datasets())

    async def images(
        self,
        filter: str = "",
        *,
        dataset: str | None = None,
        order_by: str | None = None,
        fields: Sequence[str] | None = None,
        limit: int | None = None,
    ) -> Rows:
        """Return images by their parameters and metrics."""
        return await self._run(calls.images(filter, dataset, order_by, fields, limit))

    async def stats(
        self,
        *datasets: str,
        metrics: Sequence[str] = ("uiqm", "uciqe"),
        by: Sequence[str] = (),
        filter: str = "",
    ) -> Rows:
        """Return statistics of metrics, a row for each dataset, group and metric."""
        return await self._run(calls.stats(datasets, metrics, by, filter))

    async def seal(self, dataset: str) -> dict[str, Any]:
        """Make the next version of a dataset, such as `tour@1`, and return it."""
        return await self._run(calls.seal(dataset))

    async def versions(self, dataset: str) -> Rows:
        """Return the sealed versions of a dataset."""
        return await self._run(calls.versions(dataset))

    async def verify(self, version: str, *, read_bytes: bool = False) -> dict[str, Any]:
        """Compute the root of a sealed version such as `tour@1` again, and return whether it is `intact`."""
        return await self._run(calls.verify(version, read_bytes))

    async def delete(self, name: str) -> dict[str, Any]:
        """Delete a dataset or a job with its images, a scene that no job uses, or the seal of a version."""
        return await self._run(deletion.delete(name))

    async def import_dataset(self, place: str | os.PathLike[str]) -> AsyncSubmitted:
        """Import a sharded dataset, a folder of the service's machine or a URL, and return the job of its images."""
        return AsyncSubmitted(self, await self._run(imports.import_dataset(place)))

    async def imports(self) -> Rows:
        """Return the imported sharded datasets with their progress and errors."""
        return await self._run(imports.imports())

    async def frame(self, job: str, frame: int, kinds: Sequence[str] | None = None) -> Frame:
        """Fetch an image with its record."""
        return await self._run(calls.frame(job, frame, kinds))

    async def frames(
        self,
        rows: Iterable[Mapping[str, Any]],
        kinds: Sequence[str] | None = None,
        *,
        parallel: int = calls.PARALLEL,
    ) -> AsyncIterator[Frame]:
        """Fetch the images of rows in their order, some at a time."""
        kinds = list_kinds(kinds)
        left = iter(rows)
        ahead = [self._begin(row, kinds) for row in islice(left, parallel)]
        try:
            while ahead:
                yield await ahead.pop(0)
                ahead += [self._begin(row, kinds) for row in islice(left, 1)]
        finally:
            for task in ahead:
                task.cancel()

    def _begin(self, row: Mapping[str, Any], kinds: Sequence[str] | None) -> asyncio.Task[Frame]:
        return asyncio.create_task(self.frame(row["job"], row["frame"], kinds))

    async def dataset(self, name: str, filter: str = "") -> Dataset:
        """Return the images of a dataset, for `fathom.open`. Raises `Problem` for an unknown name."""
        rows = await self.images(filter, dataset=name, fields=("job", "frame"), order_by="frame")
        return Dataset(self.server, self.token, rows, name=name)

    async def export(
        self,
        dataset: str,
        out: str | os.PathLike[str],
        *,
        format: str = "folder",
        kinds: Sequence[str] = ("rgb",),
        filter: str = "",
        split: Mapping[str, float] | None = None,
        shard_size: int | None = None,
        license: str | None = None,
    ) -> Path:
        """Export a dataset into a folder."""
        return await asyncio.to_thread(
            exports.export,
            self.server,
            self.token,
            dataset,
            out,
            format=format,
            kinds=kinds,
            filter=filter,
            split=split,
            shard_size=shard_size,
            license=license,
        )

    async def sheet(
        self,
        dataset: str,
        out: str | os.PathLike[str],
        *,
        kind: str = "rgb",
        filter: str = "",
        order_by: str | None = None,
        limit: int = 24,
    ) -> Path:
        """Draw a contact sheet of a dataset into a PNG, JPEG or WebP file, and return the file."""
        return await asyncio.to_thread(
            exports.draw_sheet,
            self.server,
            self.token,
            dataset,
            out,
            kind=kind,
            filter=filter,
            order_by=order_by,
            limit=limit,
        )
