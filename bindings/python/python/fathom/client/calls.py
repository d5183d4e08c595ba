"""Requests about jobs, datasets and images, shared by both clients."""

from __future__ import annotations

import json
import math
import os
import time
import uuid
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import httpx

from fathom.arguments import list_kinds, list_names
from fathom.client.connection import PATIENCE_S
from fathom.client.known import check_dataset, describe_dataset_problem, find_job, find_job_id
from fathom.client.protocol import WAIT_S, Call, Request, get, list_pages, path_part, read_json
from fathom.client.rows import Rows
from fathom.errors import JobTimeout, Problem
from fathom.frame import Frame
from fathom.job import Job
from fathom.progress import Progress
from fathom.stored import checked, decode_artifact

PARALLEL = 8
"""Default number of parallel artifact requests."""

Description: TypeAlias = "Job | Mapping[str, Any] | str | os.PathLike[str]"


def submit(description: Description, key: str | None) -> Call[dict[str, Any]]:
    """Submit a job; repeating it with the same key is harmless."""
    if isinstance(description, Job):
        body: str | bytes = description.canonical
    elif isinstance(description, Mapping):
        body = json.dumps(description)
    else:
        body = Path(description).read_bytes()
    sent = {"Content-Type": "application/json", "Idempotency-Key": key or str(uuid.uuid4())}
    job: dict[str, Any] = read_json((yield Request("POST", "/v1/jobs", {"content": body, "headers": sent})))
    return job


def jobs(dataset: str | None, state: str | None, limit: int | None) -> Call[list[dict[str, Any]]]:
    """List jobs, the newest first."""
    rows = yield from list_pages("/v1/jobs", dataset=dataset, state=state, limit=limit)
    if dataset is not None and not rows:
        yield from check_dataset(dataset)
    return rows


def datasets() -> Call[Rows]:
    """List datasets."""
    return Rows((yield from list_pages("/v1/datasets")))


def cancel(job: str) -> Call[dict[str, Any]]:
    """Cancel a job."""
    state: dict[str, Any] = read_json((yield from _request_about_job(job, "POST", "cancel")))
    return state


def finish_elsewhere(job: str) -> Call[dict[str, Any]]:
    """Let workers of any kind finish a job."""
    state: dict[str, Any] = read_json((yield from _request_about_job(job, "POST", "finish-elsewhere")))
    return state


def start_again(job: str) -> Call[dict[str, Any]]:
    """Remove the images of a job and render it from the beginning."""
    state: dict[str, Any] = read_json((yield from _request_about_job(job, "POST", "start-again")))
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
    is_first = True
    while state["state"] in ("queued", "running", "paused"):
        left = max(deadline - time.monotonic(), 0.0)
        if timeout is not None and left == 0.0 and not is_first:
            raise JobTimeout(state, timeout)
        is_first = False
        # Whole seconds are the unit of the service.
        hold_s = min(WAIT_S, math.ceil(left)) if math.isfinite(left) else WAIT_S
        try:
            state = yield from get(
                f"/v1/jobs/{state['id']}", wait=hold_s, since=state["version"], patience_s=min(left, PATIENCE_S)
            )
        except Problem as problem:
            if timeout is None or problem.status not in (429, 503) or time.monotonic() < deadline:
                raise
            raise JobTimeout(state, timeout) from problem
        bar.set(state["done"] + state["failed"])
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
    try:
        response = yield Request("POST", f"/v1/datasets/{path_part(dataset)}/versions")
    except Problem as problem:
        raise (yield from describe_dataset_problem(dataset, problem)) from None
    version: dict[str, Any] = read_json(response)
    return version


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
