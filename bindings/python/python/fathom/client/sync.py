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
from fathom.client import calls, deletion, exports, imports
from fathom.client.calls import Description
from fathom.client.connection import Attempts, Connection
from fathom.client.dataset import Dataset
from fathom.client.known import find_job
from fathom.client.protocol import Call, Request
from fathom.client.rows import Rows
from fathom.client.scene_methods import SceneMethods
from fathom.client.submitted import Submitted
from fathom.display import html_table
from fathom.errors import FathomError
from fathom.frame import Frame

T = TypeVar("T")


class Client(SceneMethods):
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

    def submit(self, description: Description, *, key: str | None = None, again: bool = False) -> Submitted:
        """Submit a job: a `Job`, a mapping or the path of a JSON file. The same `key` returns the same job.

        With `again=True` it is rendered even if its dataset already has all of its images. Warnings of the service are
        warnings of Python.
        """
        submitted = Submitted(self, self._run(calls.submit(description, key, again)))
        for warning in submitted.state.get("warnings") or ():
            warnings.warn(warning, stacklevel=2)
        return submitted

    def dry_run(self, description: Description, *, frames: int = 0) -> dict[str, Any]:
        """Check a job as `submit` does, without submitting it, and return its price.

        The result has `frames`, `warnings` and the `estimate`: `seconds` on the `slots` of the service, `slot_seconds`,
        `frame_seconds` and `bytes`. `first` holds the first `frames` frames, 0 to 100, with their values drawn.
        """
        return self._run(calls.dry_run(description, frames))

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
        return Submitted(self, self._run(calls.control(id, "cancel")))

    def pause(self, id: str) -> Submitted:
        """Pause a job and return it; frames being rendered are finished."""
        return Submitted(self, self._run(calls.control(id, "pause")))

    def resume(self, id: str) -> Submitted:
        """Resume a paused job and return it."""
        return Submitted(self, self._run(calls.control(id, "resume")))

    def retry(self, id: str) -> Submitted:
        """Try the failed frames of a job again and return it."""
        return Submitted(self, self._run(calls.control(id, "retry-failed")))

    def finish_elsewhere(self, id: str) -> Submitted:
        """Let workers of any version and kind of machine finish a job; images state their origin."""
        return Submitted(self, self._run(calls.control(id, "finish-elsewhere")))

    def start_again(self, id: str) -> Submitted:
        """Remove the images of a job and render it from the beginning."""
        return Submitted(self, self._run(calls.control(id, "start-again")))

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

    def versions(self, dataset: str) -> Rows:
        """Return the sealed versions of a dataset."""
        return self._run(calls.versions(dataset))

    def verify(self, version: str, *, read_bytes: bool = False) -> dict[str, Any]:
        """Compute the root of a sealed version such as `tour@1` again, from the records of all images.

        The result is `intact` or not, with `root`, `computed` and the first 100 findings in `damaged`.
        `read_bytes=True` also reads every artifact, which takes up to five minutes.
        """
        return self._run(calls.verify(version, read_bytes))

    def delete(self, name: str) -> dict[str, Any]:
        """Delete a dataset or a job with its images, a scene that no job uses, or the seal of a version.

        A job is named by its whole id. Returns the numbers of deleted `jobs`, `images` and `bytes`. There is no
        confirmation.
        """
        return self._run(deletion.delete(name))

    def import_dataset(self, place: str | os.PathLike[str]) -> Submitted:
        """Import a sharded dataset, a folder of the service's machine or a URL, and return the job of its images.

        The place must be below a `--store` of the service, and the files stay there. Repeat the call to import new
        shards. `wait` on the job raises `FathomError` if the import ends early.
        """
        return Submitted(self, self._run(imports.import_dataset(place)))

    def imports(self) -> Rows:
        """Return the imported sharded datasets with their progress and errors."""
        return self._run(imports.imports())

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

    def sheet(
        self,
        dataset: str,
        out: str | os.PathLike[str],
        *,
        kind: str = "rgb",
        filter: str = "",
        order_by: str | None = None,
        limit: int = 24,
    ) -> Path:
        """Draw a contact sheet of a dataset into a PNG, JPEG or WebP file as `fathom sheet` does, and return the file.

        `kind` is the artifact to show. Raises `CommandError`.
        """
        return exports.draw_sheet(
            self.server, self.token, dataset, out, kind=kind, filter=filter, order_by=order_by, limit=limit
        )
