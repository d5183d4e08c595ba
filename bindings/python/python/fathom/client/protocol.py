"""Requests as generators: they yield requests and receive responses, so that both clients share them.

A refused request is raised inside the generator.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any, TypeAlias, TypeVar
from urllib.parse import quote

import httpx

from fathom.client.connection import PATIENCE_S
from fathom.errors import FathomError

T = TypeVar("T")

PAGE_ROWS = 500
"""Rows per request."""
WAIT_S = 30
"""How long the service holds a request back until something changes."""


@dataclass
class Request:
    """A request below the service's address."""

    method: str
    path: str
    options: dict[str, Any] = field(default_factory=dict)
    patience_s: float = PATIENCE_S
    """How long it is repeated while the service is overloaded."""


Call: TypeAlias = Generator[Request, httpx.Response, T]


def get(path: str, *, patience_s: float = PATIENCE_S, **query: Any) -> Call[Any]:
    """Request JSON; parameters that are `None` are left out."""
    given = {name: value for name, value in query.items() if value is not None}
    return read_json((yield Request("GET", path, {"params": given}, patience_s)))


def list_pages(path: str, *, limit: int | None = None, **query: Any) -> Call[list[dict[str, Any]]]:
    """Request the rows of a list page by page."""
    rows: list[dict[str, Any]] = []
    cursor = None
    while limit is None or len(rows) < limit:
        left = PAGE_ROWS if limit is None else min(PAGE_ROWS, limit - len(rows))
        page = yield from get(path, limit=left, cursor=cursor, **query)
        rows += page["items"]
        cursor = page["next_cursor"]
        if cursor is None:
            break
    return rows


def read_json(response: httpx.Response) -> Any:
    """Return the JSON of a response. Raises `FathomError` for the response of another program."""
    try:
        return response.json()
    except ValueError as error:
        kind = response.headers.get("content-type", "unknown")
        raise FathomError(
            f"the response to {response.url} is of type {kind}, not JSON; check that the address is that of a service"
        ) from error


def path_part(name: str) -> str:
    """Return a name as one part of a path."""
    return quote(name, safe="")
