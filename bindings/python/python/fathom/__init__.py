"""Underwater image datasets on demand: frames as NumPy arrays, rendered in this process or by a service.

import fathom
job = fathom.Job({"scene": {"kind": "procedural", "family": "structure"}, "count": 100})
frame = fathom.render(job, 17)
frames = fathom.Frames(job, kinds=["rgb", "semantics"])
stream = fathom.Stream({"water": {"optics": "jerlov-3C"}})
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from importlib.metadata import version as _version
from typing import TYPE_CHECKING, Any

from fathom import _native
from fathom.errors import (
    CommandError,
    FathomError,
    FieldError,
    InvalidArgument,
    InvalidJob,
    JobTimeout,
    MissingFrames,
    MissingPackage,
    Problem,
    RenderError,
    Unreachable,
)
from fathom.frame import Artifact, Frame
from fathom.frames import Frames, Source
from fathom.job import Job
from fathom.pictures import enhance, measure
from fathom.stored import open
from fathom.stream import Stream, StreamFrame, apply
from fathom.training import Style, train

if TYPE_CHECKING:
    from fathom.client import AsyncClient, Client

__version__ = _version("fathom-datasets")

__all__ = [
    "Artifact",
    "AsyncClient",
    "Client",
    "CommandError",
    "FathomError",
    "FieldError",
    "Frame",
    "Frames",
    "InvalidArgument",
    "InvalidJob",
    "Job",
    "JobTimeout",
    "MissingFrames",
    "MissingPackage",
    "Problem",
    "RenderError",
    "Source",
    "Stream",
    "StreamFrame",
    "Style",
    "Unreachable",
    "apply",
    "enhance",
    "measure",
    "names",
    "open",
    "plan",
    "render",
    "train",
]


def render(
    job: Job | Mapping[str, Any] | str | os.PathLike[str],
    index: int = 0,
    kinds: Sequence[str] | None = None,
    *,
    metrics: bool = True,
) -> Frame:
    """Render a frame of a job in this process.

    `kinds` are the artifacts wanted, absent: those of the description; `metrics=False` leaves out what the job
    measures. Other threads of Python run meanwhile. Raises `RenderError`.
    """
    return _job(job).read(index, kinds, metrics=metrics)


def plan(job: Job | Mapping[str, Any] | str | os.PathLike[str], index: int = 0) -> dict[str, Any]:
    """Return the plan of a frame, with the keys of its record.

    `plan` lists every stage with its variant, error bound, gain and expected cost in ms. `promise` holds the `bound`
    on the error of the exposed light and its `relative` part, a share of the sample, the tolerances of both, and a
    sentence, `text`; `None` if the job asks for no tolerance.
    """
    return _job(job).plan(index)


def names() -> dict[str, list[str]]:
    """Return the names of artifacts, enhancements, families, metrics, sites, styles, waters and labels.

    `categories` stand in the order of their numbers in `semantics`, `findings` in that of their bits.
    """
    return _native.names()


def _job(job: Job | Mapping[str, Any] | str | os.PathLike[str]) -> Job:
    return job if isinstance(job, Job) else Job(job)


def __getattr__(name: str) -> Any:
    # httpx is needed for these alone.
    if name in ("Client", "AsyncClient"):
        try:
            from fathom import client
        except ModuleNotFoundError as error:
            if error.name != "httpx":
                raise
            message = f"`fathom.{name}` needs httpx, which is not installed; run: pip install 'fathom-datasets[client]'"
            raise MissingPackage(message, name="httpx") from error
        return getattr(client, name)
    raise AttributeError(f"module `fathom` has no attribute `{name}`")


def __dir__() -> list[str]:
    return sorted(__all__)
