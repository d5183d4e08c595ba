"""Exceptions with the fields of the service's problems."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


class FathomError(Exception):
    """The base of every exception of this package."""


@dataclass(frozen=True)
class FieldError:
    """An error of a description: its location, the problem and the allowed values."""

    pointer: str
    """JSON pointer (RFC 6901) into the description; empty for the whole of it."""
    message: str
    """The field, its value and the limit."""
    value: Any = None
    """The refused value, if it is short."""
    limit: str | None = None
    """The limit that it breaks, such as `0..=1`."""
    allowed: tuple[str, ...] = field(default=())
    """Allowed names, if they are a list."""
    did_you_mean: str | None = None
    """The nearest allowed name."""

    def __str__(self) -> str:
        hint = f" (did you mean `{self.did_you_mean}`?)" if self.did_you_mean else ""
        return f"{self.pointer or 'document'}: {self.message}{hint}"

    @classmethod
    def from_json(cls, fields: Mapping[str, Any]) -> FieldError:
        """Read an entry of a problem's `errors`."""
        known = {name: fields[name] for name in cls.__dataclass_fields__ if name in fields}
        return cls(**{"pointer": "", "message": ""} | known | {"allowed": tuple(fields.get("allowed", ()))})


class Problem(FathomError):
    """A request that a service refused (RFC 9457)."""

    def __init__(self, status: int, body: Mapping[str, Any]) -> None:
        self.status = status
        """HTTP status."""
        self.body = dict(body)
        """The whole problem."""
        self.type = str(body.get("type", "about:blank"))
        """What kind of problem, such as `/problems/validation`."""
        self.title = str(body.get("title", f"the service responded with {status}"))
        self.detail = body.get("detail")
        self.errors: tuple[FieldError, ...] = tuple(map(FieldError.from_json, body.get("errors", ())))
        """Every field error."""
        super().__init__(status, body)

    def __str__(self) -> str:
        head = f"{self.title}: {self.detail}" if self.detail else self.title
        return "\n  ".join([head, *map(str, self.errors)])


class InvalidJob(Problem, ValueError):
    """A description with errors, listed in `errors`."""


class RenderError(FathomError, RuntimeError):
    """A frame without an image, or without a requested artifact."""

    def __init__(self, reason: str, frame: int | None = None) -> None:
        super().__init__(reason, frame)
        self.reason = reason
        self.frame = frame

    def __str__(self) -> str:
        return self.reason if self.frame is None else f"frame {self.frame}: {self.reason}"


class InvalidArgument(FathomError, ValueError):
    """An argument with an unknown name or of the wrong type."""


class MissingPackage(FathomError, ImportError):
    """A Python package that a call needs and that is not installed."""


class MissingFrames(FathomError, FileNotFoundError):
    """A place without stored frames."""


class Unreachable(FathomError, ConnectionError):
    """A request without a response of the service: no connection, one that broke off, or a failing proxy."""


class JobTimeout(FathomError, TimeoutError):
    """A job that had not ended within the `timeout` of `wait`. The job continues."""

    def __init__(self, state: Mapping[str, Any], timeout: float) -> None:
        super().__init__(state, timeout)
        self.state = dict(state)
        """Latest state of the job."""
        self.timeout = timeout

    def __str__(self) -> str:
        ended = int(self.state["done"]) + int(self.state["failed"])
        frames = f"{ended} of {self.state['frames']} frames"
        return (
            f"job {self.state['id']} is {self.state['state']} with {frames} after {self.timeout:g} s; "
            "it continues, call `wait` again to wait longer"
        )


class CommandError(FathomError, RuntimeError):
    """A command that failed; `status` is its exit status."""

    def __init__(self, message: str, status: int = 1) -> None:
        super().__init__(message, status)
        self.status = status

    def __str__(self) -> str:
        return str(self.args[0])


def invalid_job(errors: str | Sequence[Mapping[str, Any]]) -> InvalidJob:
    """Make the exception of these field errors, or of their JSON text."""
    listed = json.loads(errors) if isinstance(errors, str) else list(errors)
    detail = f"{len(listed)} error{'s' if len(listed) > 1 else ''}"
    body = {"type": "/problems/validation", "title": "Invalid job", "detail": detail, "errors": listed}
    return InvalidJob(422, body)
