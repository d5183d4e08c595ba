"""Jobs and datasets by name; an unknown name is an error with the nearest known one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import httpx

from fathom.arguments import MOST_LISTED, find_nearest
from fathom.client.protocol import Call, Request, get, list_pages, path_part
from fathom.errors import InvalidArgument, Problem

_JOB_ID = re.compile(r"job_[0-9a-f]{32}")
_VERSION = re.compile(r"(?P<dataset>.+)@(?P<number>\d+)")


def find_job(job: str) -> Call[dict[str, Any]]:
    """Request a job by its id, or by the unique start of its id with or without `job_`."""
    if not _JOB_ID.fullmatch(job):
        return (yield from _find_job_by_prefix(job))
    try:
        found: dict[str, Any] = yield from get(f"/v1/jobs/{job}")
    except Problem as problem:
        if problem.status != 404:
            raise
        raise _describe_unknown_job(job, (yield from list_pages("/v1/jobs", limit=MOST_LISTED))) from problem
    return found


def find_job_id(job: str) -> Call[str]:
    """Return the whole id of a job. Only short ids need a request."""
    if _JOB_ID.fullmatch(job):
        return job
    return str((yield from _find_job_by_prefix(job))["id"])


def is_job_id(name: str) -> bool:
    """Whether a name is the whole id of a job."""
    return _JOB_ID.fullmatch(name) is not None


def _find_job_by_prefix(job: str) -> Call[dict[str, Any]]:
    start = job.strip().removeprefix("job_").lower()
    if not start:
        raise InvalidArgument(f"the job id is `{job}`; must be an id or the start of one")
    jobs = yield from list_pages("/v1/jobs")
    found = [row for row in jobs if row["id"].removeprefix("job_").startswith(start)]
    if len(found) > 1:
        raise InvalidArgument(
            f"`{job}` is the start of {len(found)} job ids: {_list_jobs(found)}; add characters until it is unique"
        )
    if not found:
        raise _describe_unknown_job(job, jobs)
    return found[0]


def check_dataset(name: str) -> Call[None]:
    """Raise `Problem` unless the dataset or sealed version exists."""
    try:
        yield from get(f"/v1/datasets/{path_part(name)}")
    except Problem as problem:
        raise (yield from describe_dataset_problem(name, problem)) from None


def request_about_dataset(name: str, request: Request) -> Call[httpx.Response]:
    """Send a request about a dataset or sealed version. An unknown name is an error with the nearest known one."""
    try:
        return (yield request)
    except Problem as problem:
        raise (yield from describe_dataset_problem(name, problem)) from None


def is_version(name: str) -> bool:
    """Whether a name is that of a sealed version, such as `tour@1`."""
    return _VERSION.fullmatch(name) is not None


def split_version(version: str) -> tuple[str, int]:
    """Return the dataset and the number of a sealed version such as `tour@1`."""
    found = _VERSION.fullmatch(version)
    if found is None:
        raise InvalidArgument(
            f"`version` is `{version}`; must be a sealed version such as {version}@1, "
            f'which `client.versions("{version}")` lists'
        )
    return found["dataset"], int(found["number"])


def describe_dataset_problem(name: str, problem: Problem) -> Call[Problem]:
    """Return the problem of a request about a dataset; for an unknown name with the known ones."""
    if problem.status != 404:
        return problem
    rows = yield from list_pages("/v1/datasets")
    names = [str(row["name"]) for row in rows]
    version = _VERSION.fullmatch(name)
    if version is None or version["dataset"] not in names:
        return _unknown(name, "dataset", "datasets", names, names)
    versions = yield from get(f"/v1/datasets/{path_part(version['dataset'])}/versions")
    sealed = [str(row["name"]) for row in versions["items"]]
    return _unknown(name, "sealed version", "sealed versions", sealed, sealed)


def describe_collection_problem(name: str, problem: Problem) -> Call[Problem]:
    """Return the problem of a request about a collection; for an unknown name with the known ones."""
    if problem.status != 404:
        return problem
    names = [str(row["name"]) for row in (yield from get("/v1/collections"))["items"]]
    return _unknown(name, "collection", "collections", names, names)


def _describe_unknown_job(job: str, jobs: Sequence[dict[str, Any]]) -> Problem:
    ids = [str(row["id"]) for row in jobs]
    return _unknown(job, "job", "newest jobs", ids, [_list_jobs([row]) for row in jobs])


def _list_jobs(jobs: Sequence[dict[str, Any]]) -> str:
    shown = [f"{row['id']} ({row['dataset']}, {row['state']})" for row in jobs[:MOST_LISTED]]
    return ", ".join(shown) + (f" and {len(jobs) - MOST_LISTED} more" if len(jobs) > MOST_LISTED else "")


def _unknown(name: str, kind: str, plural: str, known: Sequence[str], described: Sequence[str]) -> Problem:
    near = find_nearest(name, known)
    detail = f"no {kind} `{name}`" + (f" (did you mean `{near}`?)" if near else "")
    if described:
        more = f" and {len(described) - MOST_LISTED} more" if len(described) > MOST_LISTED else ""
        detail += f"; the {plural} are {', '.join(described[:MOST_LISTED])}{more}"
    else:
        detail += f"; the service has no {kind}"
    body = {"type": "/problems/not-found", "title": "Not found", "status": 404, "detail": detail}
    return Problem(404, body | ({"did_you_mean": near} if near else {}))
