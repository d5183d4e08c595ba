"""Imports of sharded datasets, shared by both clients."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Any

from fathom.client.known import find_job
from fathom.client.protocol import Call, Request, get, read_json
from fathom.client.rows import Rows
from fathom.errors import FathomError

WAIT_S = 5
"""How long a request waits for an import: an error of the sharded dataset does not change its job."""


def import_dataset(place: str | os.PathLike[str]) -> Call[dict[str, Any]]:
    """Import a sharded dataset and return its job. A folder is one of the service's machine."""
    url = os.fspath(place)
    if "://" not in url:
        url = os.path.abspath(url)
    view = read_json((yield Request("POST", "/v1/sets", {"json": {"url": url}})))
    return (yield from find_job(view["job"]))


def imports() -> Call[Rows]:
    """List the imported sharded datasets."""
    return Rows((yield from get("/v1/sets"))["items"])


def check_import(job: Mapping[str, Any], warned: str | None) -> Call[str | None]:
    """Raise `FathomError` if the service has given up an import; warn of an error after which it tries again.

    `warned` is the error of the last warning; returns the latest one.
    """
    view = yield from get(f"/v1/sets/{job['id']}")
    error: str | None = view.get("error")
    if error and not view["followed"]:
        raise FathomError(f"the import of {view['url']} ended: {error}")
    if error and error != warned:
        warnings.warn(f"{error}; the service tries again", stacklevel=2)
    return error
