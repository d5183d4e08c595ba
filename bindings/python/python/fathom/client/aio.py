"""The client for asyncio."""

from __future__ import annotations

import asyncio
import os
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import httpx

from fathom.client import calls, exports
from fathom.client.calls import Call, Classes, Description, Picture, Pose
from fathom.client.dataset import Dataset
from fathom.client.rows import Rows
from fathom.client.sync import SERVER
from fathom.frame import Frame
from fathom.training import Photo

T = TypeVar("T")


class AsyncClient:
    """A connection to a service; see `Client`, whose methods it has."""

    def __init__(self, server: str | None = None, *, token: str | None = None) -> None:
        """Defaults: FATHOM_SERVER and FATHOM_TOKEN."""
        self.server = server or os.environ.get("FATHOM_SERVER", SERVER)
        self.token = token or os.environ.get("FATHOM_TOKEN")
        self._http = httpx.AsyncClient(
            base_url=self.server,
            headers=calls.headers(self.token),
            timeout=calls.TIMEOUT,
            trust_env=calls.uses_proxies(self.server),
        )

    async def __aenter__(self) -> AsyncClient:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        """Close all connections."""
        await self._http.aclose()

    async def _run(self, call: Call[T]) -> T:
        try:
            request = next(call)
            while True:
                response = await self._http.request(request.method, request.path, **request.options)
                request = call.send(calls.result(response))
        except StopIteration as end:
            value: T = end.value
            return value

    async def submit(self, description: Description, *, key: str | None = None) -> AsyncSubmitted:
        """Submit a job."""
        return AsyncSubmitted(self, await self._run(calls.submit(description, key)))

    async def images(
        self,
        filter: str = "",
        *,
        dataset: str | None = None,
        order_by: str | None = None,
        fields: Sequence[str] | None = None,
        limit: int | None = None,
    ) -> Rows:
        """Ask for images by their parameters and metrics."""
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
        scale: float | None = None,
        collection: str | None = None,
        name: str | None = None,
    ) -> str:
        """Upload a scene and return its id."""
        texts: dict[str, float | str | None] = {"collection": collection, "name": name}
        numbers = {
            "unit_m": unit_m,
            "invalid_code": invalid_code,
            "focal_px": focal_px,
            "hfov_deg": hfov_deg,
            "scale": scale,
        }
        return await self._run(calls.upload(rgb, range, z_depth, instances, classes, pose, texts | numbers))

    async def train(
        self,
        photos: Photo | Sequence[Photo],
        name: str,
        *,
        steps: int | None = None,
        seed: int | None = None,
        range: bool = False,
    ) -> dict[str, Any]:
        """Train a style water on the service and wait for it."""
        return await self._run(calls.train(photos, name, {"steps": steps, "seed": seed, "range": range or None}))

    async def dataset(self, name: str, filter: str = "") -> Dataset:
        """Return the images of a dataset, for `fathom.open`."""
        rows = await self.images(filter, dataset=name, fields=("job", "frame"), order_by="frame")
        return Dataset(self.server, self.token, rows)

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


class AsyncSubmitted:
    """A job of a service."""

    def __init__(self, client: AsyncClient, state: dict[str, Any]) -> None:
        self._client = client
        self.state = state
        """Latest state from the service."""

    @property
    def id(self) -> str:
        """Its id."""
        return str(self.state["id"])

    async def wait(self, *, progress: bool = True) -> AsyncSubmitted:
        """Wait until it is finished, with a progress bar on a terminal."""
        self.state = await self._client._run(calls.wait(self.state, progress))
        return self

    async def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return await self._client._run(calls.frame_warnings(self.id))
