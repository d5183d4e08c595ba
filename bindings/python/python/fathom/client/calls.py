"""Protocol shared by both clients: generators that yield requests and receive responses."""

from __future__ import annotations

import ipaddress
import json
import os
import uuid
from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, TypeAlias, TypeVar
from urllib.parse import quote

import httpx
import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.client.rows import Rows
from fathom.errors import InvalidJob, Problem
from fathom.frame import Frame
from fathom.job import Job
from fathom.progress import Progress
from fathom.stored import checked, decode_artifact
from fathom.training import Photo

T = TypeVar("T")

PAGE_ROWS = 500
"""Rows per request."""
WAIT_S = 30
"""How long the service holds a request back until something changes."""
TIMEOUT = httpx.Timeout(90, connect=5)
"""Longer than the service holds back: beyond it the connection is dead."""
PARALLEL = 8
"""Default number of parallel artifact requests."""

Description: TypeAlias = "Job | Mapping[str, Any] | str | os.PathLike[str]"
Picture: TypeAlias = "str | os.PathLike[str] | NDArray[Any]"
Pose: TypeAlias = "str | os.PathLike[str] | NDArray[Any] | Sequence[Sequence[float]]"
Classes: TypeAlias = "Mapping[int, str] | Mapping[str, Any] | str | os.PathLike[str]"


@dataclass
class Request:
    """A request below the service's address."""

    method: str
    path: str
    options: dict[str, Any] = field(default_factory=dict)


Call: TypeAlias = Generator[Request, httpx.Response, T]


def uses_proxies(server: str) -> bool:
    """Return whether a proxy of the environment may serve this address: never for loopback."""
    host = (httpx.URL(server).host or "").lower()
    try:
        return not ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host != "localhost" and not host.endswith(".localhost")


def headers(token: str | None) -> dict[str, str]:
    """Return the headers of every request."""
    return {"Authorization": f"Bearer {token}"} if token else {}


def result(response: httpx.Response) -> httpx.Response:
    """Return a response of success; raises `Problem`, for a description `InvalidJob`."""
    if response.status_code < 400:
        return response
    try:
        body = response.json()
    except ValueError:
        body = {"title": response.text[:200]}
    is_invalid = str(body.get("type", "")).endswith("/validation")
    raise (InvalidJob if is_invalid else Problem)(response.status_code, body)


def get(path: str, **query: Any) -> Call[Any]:
    """Ask for JSON; parameters that are `None` are left out."""
    given = {name: value for name, value in query.items() if value is not None}
    return (yield Request("GET", path, {"params": given})).json()


def submit(description: Description, key: str | None) -> Call[dict[str, Any]]:
    """Submit a job; repeating it with the same key is harmless."""
    if isinstance(description, Job):
        body: str | bytes = description.canonical
    elif isinstance(description, Mapping):
        body = json.dumps(description)
    else:
        body = Path(description).read_bytes()
    sent = {"Content-Type": "application/json", "Idempotency-Key": key or str(uuid.uuid4())}
    response = yield Request("POST", "/v1/jobs", {"content": body, "headers": sent})
    job: dict[str, Any] = response.json()
    return job


def wait(job: Mapping[str, Any], progress: bool) -> Call[dict[str, Any]]:
    """Follow a job until it is finished."""
    bar = Progress(str(job["dataset"]), int(job["frames"]), progress)
    state: dict[str, Any] = dict(job)
    while state["state"] in ("queued", "running", "paused"):
        state = yield from get(f"/v1/jobs/{state['id']}", wait=WAIT_S, since=state["version"])
        bar.set(state["done"] + state["failed"])
    return state


def frame_warnings(job: str) -> Call[list[dict[str, Any]]]:
    """Ask for the warnings of a job's frames."""
    page = yield from get(f"/v1/jobs/{quote(job, safe='')}/warnings")
    return list(page["items"])


def images(
    filter: str, dataset: str | None, order_by: str | None, fields: Sequence[str] | None, limit: int | None
) -> Call[Rows]:
    """Ask for images page by page."""
    rows, cursor = Rows(), None
    while limit is None or len(rows) < limit:
        left = PAGE_ROWS if limit is None else min(PAGE_ROWS, limit - len(rows))
        page = yield from get(
            "/v1/images",
            filter=filter or None,
            dataset=dataset,
            order_by=order_by,
            fields=",".join(fields) if fields else None,
            limit=left,
            cursor=cursor,
        )
        rows += page["items"]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    return rows


def stats(datasets: Sequence[str], metrics: Sequence[str], by: Sequence[str], filter: str) -> Call[Rows]:
    """Ask for statistics of metrics, one dataset after the other."""
    rows = Rows()
    for dataset in datasets:
        answer = yield from get(
            f"/v1/datasets/{quote(dataset, safe='')}/stats",
            metrics=",".join(metrics),
            by=",".join(by) or None,
            filter=filter or None,
        )
        for entry in answer["groups"]:
            group = entry.pop("group") or {}
            rows.append({"dataset": dataset} | group | entry)
    return rows


def seal(dataset: str) -> Call[dict[str, Any]]:
    """Make the next version of a dataset."""
    response = yield Request("POST", f"/v1/datasets/{quote(dataset, safe='')}/versions")
    version: dict[str, Any] = response.json()
    return version


def frame(job: str, number: int, kinds: Sequence[str] | None) -> Call[Frame]:
    """Ask for the record of an image and its artifacts."""
    record = yield from get(f"/v1/images/{job}/{number}")
    there = {artifact["kind"]: artifact for artifact in record["artifacts"]}
    files = {}
    for kind in checked(number, kinds, there):
        response = yield Request("GET", f"/v1/images/{job}/{number}/artifacts/{kind}")
        files[kind] = decode_artifact(kind, response.content)
    return Frame(number, files, json.dumps(record))


def upload(
    rgb: Picture,
    range: Picture | None,
    z_depth: Picture | None,
    instances: Picture | None,
    classes: Classes | None,
    pose: Pose | None,
    values: Mapping[str, float | str | None],
) -> Call[str]:
    """Upload a scene and return its id."""
    given = {"rgb": rgb, "range": range, "z_depth": z_depth, "instances": instances}
    files = {name: (name, _scene_file(name, part)) for name, part in given.items() if part is not None}
    if classes is not None:
        text = json.dumps(classes).encode() if isinstance(classes, Mapping) else Path(classes).read_bytes()
        files["classes"] = ("classes", text)
    if pose is not None:
        place = Path(pose).read_bytes() if isinstance(pose, (str, os.PathLike)) else _matrix(pose)
        files["pose"] = ("pose", place)
    data = {name: str(value) for name, value in values.items() if value is not None}
    response = yield Request("POST", "/v1/scenes", {"files": files, "data": data})
    return str(response.json()["id"])


def _matrix(pose: Any) -> bytes:
    """Return the matrix of a pose as JSON."""
    matrix = np.asarray(pose, dtype=np.float64)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
        raise ValueError(f"pose has shape {matrix.shape} but a finite matrix of (4, 4) is needed")
    return json.dumps({"world_from_camera": matrix.tolist()}).encode()


def _scene_file(name: str, part: Picture) -> bytes:
    """Return the file of a part: uint8 and uint16 as PNG, other types as NPY."""
    if not isinstance(part, np.ndarray):
        return Path(part).read_bytes()
    if part.ndim not in (2, 3) or (part.ndim == 3 and part.shape[2] != 3):
        raise ValueError(f"{name} has shape {part.shape} but (height, width) or (height, width, 3) is needed")
    if part.dtype in (np.uint8, np.uint16):
        return _native.encode_png(part)
    file = BytesIO()
    if not np.issubdtype(part.dtype, np.floating):
        np.save(file, part, allow_pickle=False)
        return file.getvalue()
    if name == "rgb" and not np.isfinite(part).all():
        raise ValueError(f"{name} has {np.count_nonzero(~np.isfinite(part))} samples that are not finite")
    np.save(file, np.ascontiguousarray(part, dtype=np.float32), allow_pickle=False)
    return file.getvalue()


def train(photos: Photo | Sequence[Photo], name: str, options: Mapping[str, Any]) -> Call[dict[str, Any]]:
    """Train a style water on the service and follow it to its end."""
    given = [photos] if isinstance(photos, (str, os.PathLike, np.ndarray)) else list(photos)
    files = [("photo", ("photo", _scene_file("photo", photo))) for photo in given]
    data = {"name": name} | {key: str(value).lower() for key, value in options.items() if value is not None}
    response = yield Request("POST", "/v1/styles/train", {"files": files, "data": data})
    training: dict[str, Any] = response.json()
    while training["state"] in ("queued", "running"):
        training = yield from get(f"/v1/styles/trainings/{training['id']}", wait=WAIT_S)
    return training
