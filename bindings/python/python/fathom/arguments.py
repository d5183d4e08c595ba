"""Checks and conversions of arguments."""

from __future__ import annotations

import difflib
import operator
import os
from collections.abc import Iterable, Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from fathom import _native
from fathom.errors import InvalidArgument

MOST_LISTED = 8
"""Names that a message lists at most."""
MOST_STAMP_NS = 2**64 - 1
"""Latest stamp."""


def list_names(argument: str, names: Iterable[str]) -> tuple[str, ...]:
    """Return the names of an argument. A bare string would pass for a list of letters and raises `InvalidArgument`."""
    if isinstance(names, str):
        raise InvalidArgument(f'`{argument}` is the string "{names}"; must be a list: {argument}=["{names}"]')
    listed = tuple(names)
    for name in listed:
        if not isinstance(name, str):
            raise InvalidArgument(f"`{argument}` contains {name!r}; must be a list of names")
    return listed


def list_paths(
    styles: str | os.PathLike[str] | None, onnxruntime: str | os.PathLike[str] | None
) -> tuple[str | None, str | None]:
    """Return the folder of styles and the library of networks as strings."""
    return None if styles is None else os.fspath(styles), None if onnxruntime is None else os.fspath(onnxruntime)


def list_kinds(kinds: Iterable[str] | None) -> tuple[str, ...] | None:
    """Return the kinds of artifacts of an argument, `None` for all.

    Raises `InvalidArgument` for an unknown kind, with the nearest known one. Names of enhancements are the user's.
    """
    if kinds is None:
        return None
    listed = list_names("kinds", kinds)
    known = _known_kinds()
    for kind in listed:
        if kind not in known and not kind.startswith("enhanced."):
            raise InvalidArgument(f"artifact kind {describe_unknown(kind, known, 'kinds', most=len(known))}")
    return listed


def describe_unknown(name: str, known: Sequence[str], plural: str, *, most: int = MOST_LISTED) -> str:
    """Return an unknown name, the nearest known one and a list of the known ones."""
    near = find_nearest(name, known)
    hint = f" (did you mean `{near}`?)" if near else ""
    if not known:
        return f"`{name}` does not exist{hint}; there are no {plural}"
    more = f" and {len(known) - most} more" if len(known) > most else ""
    return f"`{name}` does not exist{hint}; the {plural} are {', '.join(known[:most])}{more}"


def find_nearest(name: str, known: Sequence[str]) -> str | None:
    """Return the known name most similar to an unknown one, `None` if all differ too much."""
    lowered = {other.lower(): other for other in reversed(known)}
    near = difflib.get_close_matches(name.lower(), lowered, n=1)
    return lowered[near[0]] if near else None


def read_stamp(stamp_ns: int | None) -> int | None:
    """Return the nanoseconds of a stamp. Raises `InvalidArgument` for other values."""
    if stamp_ns is None:
        return None
    try:
        stamp = operator.index(stamp_ns)
    except TypeError:
        raise InvalidArgument(f"`stamp_ns` is {stamp_ns!r}; must be a whole number of nanoseconds") from None
    if not 0 <= stamp <= MOST_STAMP_NS:
        raise InvalidArgument(f"`stamp_ns` is {stamp}; must be 0 to {MOST_STAMP_NS}")
    return stamp


def read_matrix(name: str, given: ArrayLike | None, side: int) -> list[list[float]] | None:
    """Return the rows of a square matrix, also from one flat list of its numbers."""
    if given is None:
        return None
    try:
        matrix = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidArgument(f"`{name}` is {given!r}; must be a {side}×{side} matrix of numbers") from None
    if matrix.shape not in ((side, side), (side * side,)):
        raise InvalidArgument(f"`{name}` has the shape {matrix.shape}; must be ({side}, {side})")
    rows: list[list[float]] = matrix.reshape(side, side).tolist()
    return rows


@cache
def _known_kinds() -> tuple[str, ...]:
    return tuple(_native.names()["artifacts"])
