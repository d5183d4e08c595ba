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
from fathom.client import calls, exports, uploads
from fathom.client.calls import Description
from fathom.client.connection import Attempts, Connection
from fathom.client.dataset import Dataset
from fathom.client.known import find_job
from fathom.client.loops import LoopClients
from fathom.client.protocol import Call, Request
from fathom.client.rows import Rows
from fathom.client.scene import Scene
from fathom.client.state import JobState
from fathom.client.uploads import Classes, Picture, Pose
from fathom.display import html_table
from fathom.errors import FathomError, JobTimeout
from fathom.frame import Frame
from fathom.training import Photo, choose_license

T = TypeVar("T")


class AsyncClient:
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

    async def submit(self, description: Description, *, key: str | None = None) -> AsyncSubmitted:
        """Submit a job. Warnings of the service are warnings of Python."""
        submitted = AsyncSubmitted(self, await self._run(calls.submit(description, key)))
        for warning in submitted.state.get("warnings") or ():
            warnings.warn(warning, stacklevel=2)
        return submitted

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
        return AsyncSubmitted(self, await self._run(calls.cancel(id)))

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

    async def upload(
        self,
        rgb: Picture,
        *,
        range: Picture | None = None,
        z_depth: Picture | None = None,
        instances: Picture | None = None,
        classes: Classes | None = None,
        pose: Pose | None = None,
        unit_m: float | None = None,
        invalid_code: int | None = None,
        focal_px: float | None = None,
        hfov_deg: float | None = None,
        cx: float | None = None,
        cy: float | None = None,
        scale: float | None = None,
        collection: str | None = None,
        name: str | None = None,
    ) -> Scene:
        """Upload a scene and return its id, which has the `summary` of its files.

        Its `notes` are warnings of Python.
        """
        parts = {"rgb": rgb, "range": range, "z_depth": z_depth, "instances": instances}
        values = {
            "collection": collection,
            "name": name,
            "unit_m": unit_m,
            "invalid_code": invalid_code,
            "focal_px": focal_px,
            "hfov_deg": hfov_deg,
            "cx": cx,
            "cy": cy,
            "scale": scale,
        }
        scene = await self._run(uploads.upload(parts, classes, pose, values))
        for note in scene.notes:
            warnings.warn(note, stacklevel=2)
        return scene

    async def train(
        self,
        photos: Photo | Sequence[Photo],
        name: str,
        *,
        steps: int | None = None,
        seed: int | None = None,
        range: bool = False,
        license: str | None = None,
        licence: str | None = None,
    ) -> dict[str, Any]:
        """Train a style water on the service and wait for it."""
        # The service stores the license under this name.
        options = {"steps": steps, "seed": seed, "range": range or None, "licence": choose_license(license, licence)}
        return await self._run(uploads.train(photos, name, options))

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
        self.state = await self._client._run(calls.cancel(self.id))
        return self

    async def finish_elsewhere(self) -> AsyncSubmitted:
        """Let workers of any version and kind of machine finish it; images state their origin."""
        self.state = await self._client._run(calls.finish_elsewhere(self.id))
        return self

    async def start_again(self) -> AsyncSubmitted:
        """Remove its images and render it from the beginning."""
        self.state = await self._client._run(calls.start_again(self.id))
        return self

    async def errors(self) -> Rows:
        """Return its failed frames, a row each."""
        return await self._client._run(calls.errors(self.id))

    async def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return await self._client._run(calls.frame_warnings(self.id))
