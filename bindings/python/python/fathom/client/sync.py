"""The client that waits."""

from __future__ import annotations

import os
import time
import warnings
import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
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


class Client:
    """A connection to a service; it closes with `close`, a `with` block or the last reference to it.

    Refused requests raise `fathom.Problem`, refused jobs `fathom.InvalidJob`, requests without a response
    `fathom.Unreachable`. A request is repeated for up to a minute while the service is overloaded.
    """

    def __init__(self, server: str | None = None, *, token: str | None = None) -> None:
        """Defaults: FATHOM_SERVER and FATHOM_TOKEN. Raises `FathomError` for an address or proxy that is no URL."""
        self._connection = Connection(server, token)
        self.server, self.token = self._connection.server, self._connection.token
        transport = httpx.HTTPTransport(**self._connection.transport_options())
        self._http = httpx.Client(transport=transport, **self._connection.options())
        self._close = weakref.finalize(self, self._http.close)

    def __repr__(self) -> str:
        return f"<fathom.Client {self._connection.name}>"

    def _repr_html_(self) -> str:
        return html_table("Fathom client", {"server": self._connection.name, "token": "set" if self.token else "none"})

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self._close()

    def _run(self, call: Call[T]) -> T:
        try:
            request = next(call)
            while True:
                try:
                    response = self._send(request)
                except FathomError as error:
                    request = call.throw(error)
                else:
                    request = call.send(response)
        except StopIteration as end:
            value: T = end.value
            return value

    def _send(self, request: Request) -> httpx.Response:
        attempts = Attempts(request.patience_s)
        while True:
            try:
                response = self._http.request(request.method, request.path, **request.options)
            except httpx.RequestError as error:
                raise self._connection.unreachable(error) from error
            pause = attempts.pause_s(response)
            if pause is None:
                return self._connection.check(response)
            time.sleep(pause)

    def submit(self, description: Description, *, key: str | None = None) -> Submitted:
        """Submit a job: a `Job`, a mapping or the path of a JSON file. The same `key` returns the same job.

        Warnings of the service are warnings of Python.
        """
        submitted = Submitted(self, self._run(calls.submit(description, key)))
        for warning in submitted.state.get("warnings") or ():
            warnings.warn(warning, stacklevel=2)
        return submitted

    def jobs(
        self, *, dataset: str | None = None, state: str | None = None, limit: int | None = None
    ) -> list[Submitted]:
        """Return the jobs of the service, the newest first.

        `state` is queued, running, paused, cancelled, done or done_with_failures.
        """
        return [Submitted(self, row) for row in self._run(calls.jobs(dataset, state, limit))]

    def job(self, id: str) -> Submitted:
        """Return a job by its id or the unique start of it."""
        return Submitted(self, self._run(find_job(id)))

    def cancel(self, id: str) -> Submitted:
        """Cancel a job and return it; its images stay."""
        return Submitted(self, self._run(calls.cancel(id)))

    def errors(self, id: str) -> Rows:
        """Return the failed frames of a job, a row each."""
        return self._run(calls.errors(id))

    def datasets(self) -> Rows:
        """Return the datasets of the service: `name`, `images`, `bytes`, `jobs`."""
        return self._run(calls.datasets())

    def images(
        self,
        filter: str = "",
        *,
        dataset: str | None = None,
        order_by: str | None = None,
        fields: Sequence[str] | None = None,
        limit: int | None = None,
    ) -> Rows:
        """Return images by their parameters and metrics, such as `uiqm > 0.5 and water.style in ("muddy")`."""
        return self._run(calls.images(filter, dataset, order_by, fields, limit))

    def stats(
        self,
        *datasets: str,
        metrics: Sequence[str] = ("uiqm", "uciqe"),
        by: Sequence[str] = (),
        filter: str = "",
    ) -> Rows:
        """Return statistics of metrics, a row for each dataset, group and metric.

        `by` names columns whose values form groups; with a width behind a colon the bins of a number, such as
        `alpha:0.1`. A row has `count`, `mean`, `sd`, `min`, `q25`, `median`, `q75` and `max`.
        """
        return self._run(calls.stats(datasets, metrics, by, filter))

    def seal(self, dataset: str) -> dict[str, Any]:
        """Make the next version of a dataset, such as `tour@1`, which never changes, and return it with its `root`."""
        return self._run(calls.seal(dataset))

    def frame(self, job: str, frame: int, kinds: Sequence[str] | None = None) -> Frame:
        """Fetch an image with its record; absent kinds: all that it has."""
        return self._run(calls.frame(job, frame, kinds))

    def frames(
        self,
        rows: Iterable[Mapping[str, Any]],
        kinds: Sequence[str] | None = None,
        *,
        parallel: int = calls.PARALLEL,
    ) -> Iterator[Frame]:
        """Fetch the images of rows in their order, some at a time."""
        kinds = list_kinds(kinds)
        with ThreadPoolExecutor(parallel) as pool:
            left = iter(rows)
            ahead = [self._begin(pool, row, kinds) for row in islice(left, 2 * parallel)]
            while ahead:
                yield ahead.pop(0).result()
                ahead += [self._begin(pool, row, kinds) for row in islice(left, 1)]

    def _begin(self, pool: ThreadPoolExecutor, row: Mapping[str, Any], kinds: Sequence[str] | None) -> Future[Frame]:
        return pool.submit(self.frame, row["job"], row["frame"], kinds)

    def upload(
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
        """Upload a scene and return its id, which has the `summary` of its files. Its `notes` are warnings of Python.

        Each part is a file or an array: `rgb` uint8 or uint16 codes, or float linear radiance, (H, W, 3); `range` or
        `z_depth` float meters or integers of `unit_m` meters, (H, W); `instances` whole numbers, (H, W). `scale` is the
        factor from the floats of `rgb` to linear light, where 1 is white. `classes` names the instances:
        `{1: "pile", 2: "chain"}`, COCO's `categories` and `segments_info`, or a JSON file. `pose` is the pose of the
        camera: the (4, 4) matrix from camera axes (right, down, ahead) to the world, or a JSON file. The camera is
        `focal_px` or `hfov_deg`, with the principal point `cx`, `cy` in pixels. With a camera, the channel Z of an EXR
        picture is its z-depth.
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
        scene = self._run(uploads.upload(parts, classes, pose, values))
        for note in scene.notes:
            warnings.warn(note, stacklevel=2)
        return scene

    def train(
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
        """Train a style water on the service, wait for it and return the training with its `state`."""
        # The service stores the license under this name.
        options = {"steps": steps, "seed": seed, "range": range or None, "licence": choose_license(license, licence)}
        return self._run(uploads.train(photos, name, options))

    def dataset(self, name: str, filter: str = "") -> Dataset:
        """Return the images of a dataset, for `fathom.open`. Raises `Problem` for an unknown name."""
        rows = self.images(filter, dataset=name, fields=("job", "frame"), order_by="frame")
        return Dataset(self.server, self.token, rows, name=name)

    def export(
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
        """Export a dataset into a folder as `fathom export` does, and return the folder.

        `format` is one of folder, webdataset, parquet, hf, coco, yolo, colmap, transforms, mcap, tum, euroc and kitti;
        `split` names parts with their shares, such as `{"train": 0.8, "val": 0.2}`. Repeat the call to resume.
        Raises `CommandError`.
        """
        return exports.export(
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
        self.state = self._client._run(calls.cancel(self.id))
        return self

    def finish_elsewhere(self) -> Submitted:
        """Let workers of any version and kind of machine finish it; images state their origin."""
        self.state = self._client._run(calls.finish_elsewhere(self.id))
        return self

    def start_again(self) -> Submitted:
        """Remove its images and render it from the beginning."""
        self.state = self._client._run(calls.start_again(self.id))
        return self

    def errors(self) -> Rows:
        """Return its failed frames, a row each."""
        return self._client._run(calls.errors(self.id))

    def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return self._client._run(calls.frame_warnings(self.id))
