"""The client that waits."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import httpx

from fathom.client import calls, exports
from fathom.client.calls import Call, Classes, Description, Picture, Pose
from fathom.client.dataset import Dataset
from fathom.client.rows import Rows
from fathom.frame import Frame
from fathom.training import Photo

T = TypeVar("T")
SERVER = "http://127.0.0.1:7311"


class Client:
    """A connection to a service. Refused requests raise `fathom.Problem`, refused jobs `fathom.InvalidJob`."""

    def __init__(self, server: str | None = None, *, token: str | None = None) -> None:
        """Defaults: FATHOM_SERVER and FATHOM_TOKEN."""
        self.server = server or os.environ.get("FATHOM_SERVER", SERVER)
        self.token = token or os.environ.get("FATHOM_TOKEN")
        self._http = httpx.Client(
            base_url=self.server,
            headers=calls.headers(self.token),
            timeout=calls.TIMEOUT,
            trust_env=calls.uses_proxies(self.server),
        )

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self._http.close()

    def _run(self, call: Call[T]) -> T:
        try:
            request = next(call)
            while True:
                response = self._http.request(request.method, request.path, **request.options)
                request = call.send(calls.result(response))
        except StopIteration as end:
            value: T = end.value
            return value

    def submit(self, description: Description, *, key: str | None = None) -> Submitted:
        """Submit a job: a `Job`, a mapping or the path of a JSON file. The same `key` returns the same job."""
        return Submitted(self, self._run(calls.submit(description, key)))

    def images(
        self,
        filter: str = "",
        *,
        dataset: str | None = None,
        order_by: str | None = None,
        fields: Sequence[str] | None = None,
        limit: int | None = None,
    ) -> Rows:
        """Ask for images by their parameters and metrics, such as `uiqm > 0.5 and water.style in ("muddy")`."""
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
        scale: float | None = None,
        collection: str | None = None,
        name: str | None = None,
    ) -> str:
        """Upload a scene and return its id.

        Each part is a file or an array: `rgb` uint8 or uint16 codes, or float linear radiance, (H, W, 3); `range` or
        `z_depth` float meters or integers of `unit_m` meters, (H, W); `instances` whole numbers, (H, W). `scale` is the
        factor from the floats of `rgb` to linear light, where 1 is white. `classes` names the instances:
        `{1: "pile", 2: "chain"}`, COCO's `categories` and `segments_info`, or a JSON file. `pose` is the pose of the
        camera: the (4, 4) matrix from camera axes (right, down, ahead) to the world, or a JSON file.
        """
        texts: dict[str, float | str | None] = {"collection": collection, "name": name}
        numbers = {
            "unit_m": unit_m,
            "invalid_code": invalid_code,
            "focal_px": focal_px,
            "hfov_deg": hfov_deg,
            "scale": scale,
        }
        return self._run(calls.upload(rgb, range, z_depth, instances, classes, pose, texts | numbers))

    def train(
        self,
        photos: Photo | Sequence[Photo],
        name: str,
        *,
        steps: int | None = None,
        seed: int | None = None,
        range: bool = False,
    ) -> dict[str, Any]:
        """Train a style water on the service, wait for it and return the training with its `state`."""
        return self._run(calls.train(photos, name, {"steps": steps, "seed": seed, "range": range or None}))

    def dataset(self, name: str, filter: str = "") -> Dataset:
        """Return the images of a dataset, for `fathom.open`."""
        rows = self.images(filter, dataset=name, fields=("job", "frame"), order_by="frame")
        return Dataset(self.server, self.token, rows)

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

        `format` is one of folder, webdataset, parquet, hf, coco, yolo, colmap and transforms; `split` names parts with
        their shares, such as `{"train": 0.8, "val": 0.2}`. Repeat the call to resume. Raises `CommandError`.
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


class Submitted:
    """A job of a service."""

    def __init__(self, client: Client, state: dict[str, Any]) -> None:
        self._client = client
        self.state = state
        """Latest state from the service: `id`, `state`, `frames`, `done`, `failed`, `digest`."""

    @property
    def id(self) -> str:
        """Its id."""
        return str(self.state["id"])

    def wait(self, *, progress: bool = True) -> Submitted:
        """Wait until it is finished, with a progress bar on a terminal."""
        self.state = self._client._run(calls.wait(self.state, progress))
        return self

    def frame_warnings(self) -> list[dict[str, Any]]:
        """Return the warnings of its frames, the most frequent first: `warning`, `frames`, `first_frame`."""
        return self._client._run(calls.frame_warnings(self.id))
