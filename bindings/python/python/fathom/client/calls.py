"""Requests about jobs, datasets and images, shared by both clients."""

from __future__ import annotations

import json
import math
import os
import time
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias

import httpx

from fathom.arguments import list_kinds, list_names
from fathom.client import imports
from fathom.client.connection import PATIENCE_S, VERIFY_TIMEOUT
from fathom.client.known import (
    check_dataset,
    describe_collection_problem,
    describe_dataset_problem,
    find_job,
    find_job_id,
    request_about_dataset,
    split_version,
)
from fathom.client.protocol import WAIT_S, Call, Request, get, list_pages, path_part, read_json
from fathom.client.rows import Rows
from fathom.client.scene import Scene
from fathom.errors import JobTimeout, Problem
from fathom.frame import Frame
from fathom.job import Job
from fathom.progress import Progress
from fathom.stored import checked, decode_artifact

PARALLEL = 8
"""Default number of parallel artifact requests."""

Description: TypeAlias = "Job | Mapping[str, Any] | str | os.PathLike[str]"
Action: TypeAlias = Literal["cancel", "finish-elsewhere", "pause", "resume", "retry-failed", "start-again"]
"""A change of the state of a job, as the service names it."""


def submit(description: Description, key: str | None, again: bool) -> Call[dict[str, Any]]:
    """Submit a job; repeating it with the same key is harmless."""
    options = _json_body(description, {"Idempotency-Key": key or str(uuid.uuid4())})
    if again:
        options["params"] = {"again": "true"}
    job: dict[str, Any] = read_json((yield Request("POST", "/v1/jobs", options)))
    return job


def dry_run(description: Description, frames: int) -> Call[dict[str, Any]]:
    """Check a job and request its price without submitting it."""
    options = _json_body(description, {}) | {"params": {"frames": frames}}
    preview: dict[str, Any] = read_json((yield Request("POST", "/v1/jobs/preview", options)))
    return preview


def read_body(description: Description) -> str | bytes:
    """Return a description as JSON."""
    if isinstance(description, Job):
        return description.canonical
    if isinstance(description, Mapping):
        return json.dumps(description)
    return Path(description).read_bytes()


def _json_body(description: Description, headers: Mapping[str, str]) -> dict[str, Any]:
    return {"content": read_body(description), "headers": {"Content-Type": "application/json", **headers}}


def jobs(dataset: str | None, state: str | None, limit: int | None) -> Call[list[dict[str, Any]]]:
    """List jobs, the newest first."""
    rows = yield from list_pages("/v1/jobs", dataset=dataset, state=state, limit=limit)
    if dataset is not None and not rows:
        yield from check_dataset(dataset)
    return rows


def datasets() -> Call[Rows]:
    """List datasets."""
    return Rows((yield from list_pages("/v1/datasets")))


def control(job: str, action: Action) -> Call[dict[str, Any]]:
    """Change the state of a job and return it."""
    state: dict[str, Any] = read_json((yield from _request_about_job(job, "POST", action)))
    return state


def errors(job: str) -> Call[Rows]:
    """Request the failed frames of a job."""
    response = yield from _request_about_job(job, "GET", "errors")
    return Rows(json.loads(line) for line in response.text.splitlines() if line)


def _request_about_job(job: str, method: str, part: str) -> Call[httpx.Response]:
    """Request a part of a job. An unknown id is an error with the nearest known one."""
    found = yield from find_job_id(job)
    try:
        return (yield Request(method, f"/v1/jobs/{found}/{part}"))
    except Problem as problem:
        if problem.status == 404:
            yield from find_job(job)
        raise


def wait(job: Mapping[str, Any], progress: bool, timeout: float | None) -> Call[dict[str, Any]]:
    """Follow a job until it ends. Raises `JobTimeout` with its latest state."""
    deadline = math.inf if timeout is None else time.monotonic() + timeout
    bar = Progress(str(job["dataset"]), int(job["frames"]), progress)
    state: dict[str, Any] = dict(job)
    is_first, warned = True, None
    while state["state"] in ("queued", "running", "paused"):
        left = max(deadline - time.monotonic(), 0.0)
        if timeout is not None and left == 0.0 and not is_first:
            raise JobTimeout(state, timeout)
        is_first = False
        # Whole seconds are the unit of the service.
        longest_s = imports.WAIT_S if job.get("set") else WAIT_S
        hold_s = min(longest_s, math.ceil(left)) if math.isfinite(left) else longest_s
        try:
            state = yield from get(
                f"/v1/jobs/{state['id']}", wait=hold_s, since=state["version"], patience_s=min(left, PATIENCE_S)
            )
        except Problem as problem:
            if timeout is None or problem.status not in (429, 503) or time.monotonic() < deadline:
                raise
            raise JobTimeout(state, timeout) from problem
        bar.set(state["done"] + state["failed"])
        if job.get("set"):
            warned = yield from imports.check_import(job, warned)
    return state


def frame_warnings(job: str) -> Call[list[dict[str, Any]]]:
    """Request the warnings of a job's frames."""
    page = yield from get(f"/v1/jobs/{path_part(job)}/warnings")
    return list(page["items"])


def images(
    filter: str, dataset: str | None, order_by: str | None, fields: Sequence[str] | None, limit: int | None
) -> Call[Rows]:
    """Request images page by page."""
    rows = yield from list_pages(
        "/v1/images",
        filter=filter or None,
        dataset=dataset,
        order_by=order_by,
        fields=",".join(list_names("fields", fields)) if fields else None,
        limit=limit,
    )
    if dataset is not None and not rows and limit != 0:
        yield from check_dataset(dataset)
    return Rows(rows)


def stats(datasets: Sequence[str], metrics: Sequence[str], by: Sequence[str], filter: str) -> Call[Rows]:
    """Request statistics of metrics, one dataset after the other."""
    rows = Rows()
    path, columns = "/v1/datasets/{}/stats", ",".join(list_names("by", by)) or None
    names = ",".join(list_names("metrics", metrics))
    for dataset in datasets:
        try:
            page = yield from get(path.format(path_part(dataset)), metrics=names, by=columns, filter=filter or None)
        except Problem as problem:
            raise (yield from describe_dataset_problem(dataset, problem)) from None
        for entry in page["groups"]:
            group = entry.pop("group") or {}
            rows.append({"dataset": dataset} | group | entry)
    return rows


def seal(dataset: str) -> Call[dict[str, Any]]:
    """Make the next version of a dataset."""
    request = Request("POST", f"/v1/datasets/{path_part(dataset)}/versions")
    version: dict[str, Any] = read_json((yield from request_about_dataset(dataset, request)))
    return version


def versions(dataset: str) -> Call[Rows]:
    """List the sealed versions of a dataset."""
    request = Request("GET", f"/v1/datasets/{path_part(dataset)}/versions")
    return Rows(read_json((yield from request_about_dataset(dataset, request)))["items"])


def verify(version: str, read_bytes: bool) -> Call[dict[str, Any]]:
    """Compute the root of a sealed version again."""
    dataset, number = split_version(version)
    path = f"/v1/datasets/{path_part(dataset)}/versions/{number}/verify"
    options = {"json": {"bytes": read_bytes}, "timeout": VERIFY_TIMEOUT}
    found: dict[str, Any] = read_json((yield from request_about_dataset(version, Request("POST", path, options))))
    return found


def scenes(collection: str | None, limit: int | None) -> Call[list[Scene]]:
    """List uploaded scenes, the newest first, or those of a collection in its order."""
    if collection is None:
        return [Scene(row) for row in (yield from list_pages("/v1/scenes", limit=limit))]
    try:
        page = yield from get(f"/v1/collections/{path_part(collection)}")
    except Problem as problem:
        raise (yield from describe_collection_problem(collection, problem)) from None
    return [Scene(row) for row in page["items"][:limit]]


def frame(job: str, number: int, kinds: Sequence[str] | None) -> Call[Frame]:
    """Request the record of an image and its artifacts."""
    wanted = list_kinds(kinds)
    path = f"/v1/images/{path_part(job)}/{number}"
    record = yield from get(path)
    there = {artifact["kind"]: artifact for artifact in record["artifacts"]}
    files = {}
    for kind in checked(number, wanted, there):
        response = yield Request("GET", f"{path}/artifacts/{kind}")
        files[kind] = decode_artifact(kind, response.content)
    return Frame(number, files, json.dumps(record))


def waters() -> Call[Rows]:
    """List the optical waters."""
    return Rows((yield from get("/v1/waters"))["items"])


def add_water(water: Mapping[str, Any] | str | os.PathLike[str]) -> Call[dict[str, Any]]:
    """Add a custom water: a mapping or the path of a JSON file."""
    text = json.dumps(water) if isinstance(water, Mapping) else Path(water).read_bytes()
    options = {"content": text, "headers": {"Content-Type": "application/json"}}
    added: dict[str, Any] = read_json((yield Request("POST", "/v1/waters", options)))
    return added


def styles(role: str | None) -> Call[Rows]:
    """List the networks: style waters, enhancers and metrics."""
    return Rows((yield from get("/v1/styles", role=role))["items"])
