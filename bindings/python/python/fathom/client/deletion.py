"""Deletion of jobs, datasets, sealed versions, scenes and collections, shared by both clients."""

from __future__ import annotations

import re
from typing import Any

from fathom.client.known import (
    describe_collection_problem,
    describe_dataset_problem,
    find_job,
    is_job_id,
    is_version,
    split_version,
)
from fathom.client.protocol import Call, Request, path_part
from fathom.errors import Problem

_SCENE_ID = re.compile(r"scn_[0-9a-f]{32}")
_NOTHING = {"jobs": 0, "images": 0, "bytes": 0}
"""What the deletion of a version, scene or collection frees."""


def delete(name: str) -> Call[dict[str, Any]]:
    """Delete a job, dataset, sealed version or scene. A job is named by its whole id."""
    if is_job_id(name):
        path = f"/v1/jobs/{name}"
    elif _SCENE_ID.fullmatch(name):
        path = f"/v1/scenes/{name}"
    elif is_version(name):
        dataset, number = split_version(name)
        path = f"/v1/datasets/{path_part(dataset)}/versions/{number}"
    else:
        path = f"/v1/datasets/{path_part(name)}"
    try:
        response = yield Request("DELETE", path)
    except Problem as problem:
        if is_job_id(name) and problem.status == 404:
            yield from find_job(name)
        if path.startswith("/v1/datasets/"):
            raise (yield from describe_dataset_problem(name, problem)) from None
        raise
    return dict(_NOTHING) if response.status_code == 204 else response.json()


def delete_collection(name: str) -> Call[None]:
    """Delete a collection; its scenes stay."""
    try:
        yield Request("DELETE", f"/v1/collections/{path_part(name)}")
    except Problem as problem:
        raise (yield from describe_collection_problem(name, problem)) from None
