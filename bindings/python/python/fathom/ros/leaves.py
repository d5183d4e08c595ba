"""The leaves of a description as parameters of ROS, and changes of single leaves.

A leaf is named by its path, with dots: `water.optics.preset`, `lights.0.intensity`. Lists of numbers, strings or
booleans are one leaf. Empty lists and objects, which ROS cannot type, are leaves with the text `[]` and `{}`.
"""

from __future__ import annotations

import ast
import copy
import json
from collections.abc import Mapping
from typing import Any

from fathom.errors import InvalidArgument

REMOVED = object()
"""The value of a change that removes a leaf, or everything below a path."""

_LEAST_INTEGER, _MOST_INTEGER = -(2**63), 2**63 - 1
_SEPARATOR = "."
_DISTRIBUTIONS = {"choice", "clip", "grid", "int", "log_uniform", "normal", "uniform", "weights"}
"""Keys of distributions, which replace a list as well as a number."""


def flatten(description: Mapping[str, Any]) -> dict[str, Any]:
    """Return every leaf by its name; raises `InvalidArgument` for one that ROS has no type for."""
    leaves: dict[str, Any] = {}
    for key, value in description.items():
        _collect(key, value, leaves)
    return leaves


def _collect(name: str, value: Any, leaves: dict[str, Any]) -> None:
    if isinstance(value, Mapping) and value:
        for key, inner in value.items():
            _collect(f"{name}{_SEPARATOR}{key}", inner, leaves)
        return
    if isinstance(value, list) and value and not _is_plain(value):
        for index, inner in enumerate(value):
            _collect(f"{name}{_SEPARATOR}{index}", inner, leaves)
        return
    leaves[name] = _convert_leaf(name, value)


def _is_plain(values: list[Any]) -> bool:
    """Whether ROS has an array type for the list."""
    if all(isinstance(value, bool) for value in values) or all(isinstance(value, str) for value in values):
        return True
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values)


def _convert_leaf(name: str, value: Any) -> Any:
    if isinstance(value, (Mapping, list)) and not value:
        return json.dumps(value)
    if isinstance(value, list) and any(isinstance(item, float) for item in value):
        return [float(item) for item in value]
    for item in value if isinstance(value, list) else [value]:
        if isinstance(item, int) and not _LEAST_INTEGER <= item <= _MOST_INTEGER:
            raise InvalidArgument(f"`{name}` is {item}; must be at most {_MOST_INTEGER} as a parameter of ROS")
    return value


def change(description: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the description with changed leaves; raises `InvalidArgument` for a path that does not exist.

    A value replaces everything at its path: a number replaces a distribution, and a text such as `[]` or `{"kind": …}`
    is read as JSON and replaces a list or an object. The index after the last one of a list appends to it. Elements
    that other changes of one call need come first in the order of their names.
    """
    changed: dict[str, Any] = copy.deepcopy(dict(description))
    for name in sorted(changes, key=_order_naturally):
        _apply(changed, name, _read_value(name, changes[name]))
    return changed


def _order_naturally(name: str) -> list[tuple[int, int, str]]:
    """Order numbers in a path by value, so that lights.9 is before lights.10."""
    return [(0, int(part), "") if part.isdecimal() else (1, 0, part) for part in name.split(_SEPARATOR)]


def _read_value(name: str, value: Any) -> Any:
    if not isinstance(value, str) or value.lstrip()[:1] not in ("[", "{"):
        return value
    try:
        return json.loads(value)
    except ValueError as error:
        problem = error
    try:
        # `ros2 param set` turns an object into the text of a dictionary of Python.
        return json.loads(json.dumps(ast.literal_eval(value)))
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        raise InvalidArgument(f"`{name}` is {value!r}, which is no JSON: {problem}") from None


def _apply(root: dict[str, Any], name: str, value: Any) -> None:
    parts = name.split(_SEPARATOR)
    if not all(parts):
        raise InvalidArgument(f"`{name}` has an empty part; must be a path such as `lights.0.intensity`")
    holder: Any = root
    for depth, part in enumerate(parts[:-1]):
        inner = _find(holder, part, name, parts[:depth])
        if not _has_place(inner, parts[depth + 1]):
            if value is REMOVED:
                return
            inner = [] if parts[depth + 1].isdecimal() else {}
            _store(holder, part, inner)
        holder = inner
    _find(holder, parts[-1], name, parts[:-1])
    if value is REMOVED:
        _remove(holder, parts[-1])
    else:
        _store(holder, parts[-1], value)


def _has_place(inner: Any, part: str) -> bool:
    """Whether a value holds this part of a path, else a list or object replaces it.

    A distribution replaces a list, and an element of a list replaces a distribution.
    """
    if isinstance(inner, list):
        return part not in _DISTRIBUTIONS
    return isinstance(inner, dict) and not (part.isdecimal() and _DISTRIBUTIONS & inner.keys())


def _find(holder: Any, part: str, name: str, path: list[str]) -> Any:
    """Return the value at a part of a path, `None` if it is new."""
    if isinstance(holder, dict):
        return holder.get(part)
    length = len(holder)
    if not part.isdecimal() or int(part) > length:
        listed = _SEPARATOR.join(path)
        raise InvalidArgument(f"`{name}` does not exist: `{listed}` has {length} elements; the next index is {length}")
    return holder[int(part)] if int(part) < length else None


def _store(holder: Any, part: str, value: Any) -> None:
    if isinstance(holder, dict):
        holder[part] = value
    elif int(part) == len(holder):
        holder.append(value)
    else:
        holder[int(part)] = value


def _remove(holder: Any, part: str) -> None:
    if isinstance(holder, dict):
        holder.pop(part, None)
    elif int(part) < len(holder):
        del holder[int(part)]
