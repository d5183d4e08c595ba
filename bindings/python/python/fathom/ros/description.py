"""The job of the node: from a file, a site or parameters to an open stream."""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fathom.errors import InvalidArgument, InvalidJob
from fathom.job import Job
from fathom.ros.leaves import change
from fathom.ros.settings import Settings
from fathom.stream import Stream

_COMMENT = re.compile(r'("(?:\\.|[^"\\])*")|//[^\n]*')
_OF_DATASETS = ("artifacts", "count", "dataset", "encode", "labels", "metrics", "scene", "site")
"""Fields of a job that change no picture of a stream."""
_OF_RENDERED_CAMERAS = ("frames_per_s", "height", "path", "stereo", "supersample", "view", "width")
"""Fields of `camera` that need a procedural scene."""
_SCENES = (
    {"kind": "procedural", "family": "structure", "lighting": "in_air"},
    {"kind": "files", "rgb": "image", "range": "depth"},
)
"""Scenes of which one has everything that a job can need; the pictures of the topics replace it."""


def start_description(settings: Settings, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the job of the settings `job` or `site` with changed leaves, its defaults filled in.

    Raises `InvalidArgument` and `InvalidJob`.
    """
    if settings.job and settings.site:
        raise InvalidArgument(f'`job` is "{settings.job}" and `site` is "{settings.site}"; give one of them')
    if not settings.site:
        written = _read_file(settings.job) if settings.job else {}
        return change_description(_fill(written, settings), changes, settings)
    described = _fill({"site": settings.site}, settings)
    if settings.use_camera_info:
        # The camera of the topics replaces that of the site.
        described.get("camera", {}).pop("hfov_deg", None)
    return change_description(described, changes, settings)


def change_description(
    description: Mapping[str, Any], changes: Mapping[str, Any], settings: Settings
) -> dict[str, Any]:
    """Return the job with changed leaves, its defaults filled in; raises `InvalidArgument` for one without effect."""
    for name in changes:
        first, _, rest = name.partition(".")
        if (first in _OF_DATASETS and first != "site") or (
            first == "camera" and rest.partition(".")[0] in _OF_RENDERED_CAMERAS
        ):
            raise InvalidArgument(f"`{name}` changes no picture of a topic; leave it out")
    return _fill(change(description, changes), settings)


def list_ignored(settings: Settings) -> list[str]:
    """Return the fields in the file of the job that change no picture of a topic."""
    written = _read_file(settings.job) if settings.job else {}
    return [name for name in _OF_DATASETS if name in written and name != "site"]


def open_stream(description: Mapping[str, Any], settings: Settings) -> Stream:
    """Open the stream of a job in the mode of the settings; raises `InvalidJob` and `InvalidArgument`."""
    # Its warnings are those of the stream, which the node reports.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return Stream(
            select_mode(description, settings.mode),
            vary="frame" if settings.vary == "frame" else "stream",
            deadline_ms=settings.deadline_ms or None,
            styles=settings.styles or None,
            onnxruntime=settings.onnxruntime or None,
        )


def select_mode(description: Mapping[str, Any], mode: str) -> dict[str, Any]:
    """Return the fields that a mode uses; enhancement is HSCM unless the job has others."""
    selected = dict(description)
    if mode == "water":
        selected.pop("enhance", None)
    elif not selected.get("enhance"):
        selected["enhance"] = ["hscm"]
    if mode == "enhance":
        return {name: selected[name] for name in ("enhance", "seed") if name in selected}
    return selected


def list_enhancements(description: Mapping[str, Any], mode: str) -> list[str]:
    """Return the names of the results of `enhance` as far as they are the same for all frames."""
    entries = select_mode(description, mode).get("enhance", [])
    if not isinstance(entries, list):
        return []
    named = [entry.get("name") or entry.get("method") if isinstance(entry, dict) else entry for entry in entries]
    return [name.partition(":")[0] for name in named if isinstance(name, str)]


def _read_file(path: str) -> dict[str, Any]:
    try:
        text = Path(path).expanduser().read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidArgument(f'`job` is "{path}", which cannot be read: {error}') from None
    try:
        written = json.loads(_COMMENT.sub(lambda found: found[1] or "", text))
    except ValueError as error:
        raise InvalidArgument(f'`job` is "{path}", which is no JSON: {error}') from None
    if not isinstance(written, dict):
        raise InvalidArgument(f'`job` is "{path}"; must hold a JSON object')
    return written


def _fill(written: Mapping[str, Any], settings: Settings) -> dict[str, Any]:
    """Return the fields that change pictures with their defaults; as written if the job has errors.

    Opening the stream reports these. Errors of a site are reported here, because its fields replace its name.
    """
    has_scene = "scene" in written or "site" in written
    scenes = [{}] if has_scene else [{"scene": scene, "artifacts": ["rgb"], "metrics": []} for scene in _SCENES]
    for scene in scenes:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                job = Job(
                    dict(written) | scene,
                    styles=settings.styles or None,
                    onnxruntime=settings.onnxruntime or None,
                )
                return _drop_unused(job.description)
        except InvalidJob:
            if "site" in written:
                raise
    return _drop_unused(written)


def _drop_unused(description: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields that change pictures of a stream; several sites stay, because each frame draws one."""
    kept = {name: value for name, value in description.items() if name not in _OF_DATASETS}
    site = description.get("site")
    if isinstance(site, dict) and set(site) != {"name"}:
        kept["site"] = site
    if isinstance(kept.get("camera"), dict):
        kept["camera"] = {name: value for name, value in kept["camera"].items() if name not in _OF_RENDERED_CAMERAS}
    if kept.get("fidelity") == "picture":
        # The default, which a stream with a deadline refuses if it is given.
        del kept["fidelity"]
    return kept
