"""Jobs: frame descriptions with laws in place of values."""

from __future__ import annotations

import json
import math
import os
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fathom import _native
from fathom.arguments import list_kinds, list_paths
from fathom.display import html_table
from fathom.frame import Frame

MAX_FRAMES = 100_000_000
"""Most frames of a job."""


class Job:
    """A frame description with laws in place of values, checked at once.

    `len(job)` frames, each a pure function of the description and its index. A job can be pickled: another process
    checks the description again and renders the same frames.
    """

    def __init__(
        self,
        description: Mapping[str, Any] | str | os.PathLike[str],
        *,
        styles: str | os.PathLike[str] | None = None,
        onnxruntime: str | os.PathLike[str] | None = None,
    ) -> None:
        """Check a description: a mapping, or the path of a JSON file.

        `styles` is a folder with more style models (NAME.onnx), `onnxruntime` the library file for networks of foreign
        architecture. Raises `InvalidJob` with every error of the description.
        """
        text = read_description(description)
        self._load(text, *list_paths(styles, onnxruntime))
        for warning in self.warnings:
            warnings.warn(warning, stacklevel=2)

    def _load(self, text: str, styles: str | None, onnxruntime: str | None) -> None:
        self._places = (styles, onnxruntime)
        self._native = _native.Job(text, styles, onnxruntime)

    def __len__(self) -> int:
        return self._native.frames

    def __repr__(self) -> str:
        return f"<fathom.Job {self.digest[:12]}: {len(self)} frames of {self.description.get('dataset')}>"

    def _repr_html_(self) -> str:
        description = self.description
        camera, scene = (description.get(part) or {} for part in ("camera", "scene"))
        rows = {
            "dataset": description.get("dataset"),
            "frames": len(self),
            "size": f"{camera.get('width')}×{camera.get('height')}" if "width" in camera else None,
            "scene": " ".join(str(scene[name]) for name in ("kind", "family", "name", "id") if name in scene),
            "water": ", ".join(_list_presets(description.get("water"))),
            "artifacts": ", ".join(map(str, description.get("artifacts") or ())),
            "warnings": "; ".join(self.warnings),
            "digest": self.digest,
        }
        return html_table("Job", rows)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Job) and (self.canonical, self._places) == (other.canonical, other._places)

    def __hash__(self) -> int:
        return hash(self.canonical)

    def __getstate__(self) -> tuple[str, tuple[str | None, str | None]]:
        return self.canonical, self._places

    def __setstate__(self, state: tuple[str, tuple[str | None, str | None]]) -> None:
        self._load(state[0], *state[1])

    @property
    def places(self) -> tuple[str | None, str | None]:
        """Folder of more style models and library of networks, as given."""
        return self._places

    @property
    def canonical(self) -> str:
        """Canonical JSON text: sorted keys, defaults filled in, laws kept."""
        return self._native.canonical

    @property
    def digest(self) -> str:
        """SHA-256 of the canonical text, lower-case hex."""
        return self._native.digest

    @property
    def description(self) -> dict[str, Any]:
        """The description with its defaults."""
        result: dict[str, Any] = json.loads(self.canonical)
        return result

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings."""
        return tuple(self._native.warnings)

    def resolve(self, index: int) -> dict[str, Any]:
        """Return the parameters of a frame: the description with every law replaced by its value."""
        result: dict[str, Any] = json.loads(self._native.resolve(self._position(index)))
        return result

    def plan(self, index: int) -> dict[str, Any]:
        """Return the `plan` of a frame, a list of stages, and its `promise` of an error: see `fathom.plan`."""
        result: dict[str, Any] = json.loads(self._native.plan(self._position(index)))
        return result

    def read(self, index: int, kinds: Sequence[str] | None = None, *, metrics: bool = False) -> Frame:
        """Render a frame in this process; see `fathom.render`."""
        wanted = list_kinds(kinds)
        position = self._position(index)
        artifacts, record = self._native.render(position, None if wanted is None else list(wanted), metrics)
        return Frame(position, dict(artifacts), record)

    def endless(self) -> Job:
        """Return the same job with the largest count there is: frames that both have are the same."""
        description = self.description
        cells = len(self) // description["count"]
        endless = object.__new__(Job)
        endless._load(json.dumps(description | {"count": MAX_FRAMES // cells}), *self._places)
        return endless

    def _position(self, index: int) -> int:
        position = index + len(self) if index < 0 else index
        if not 0 <= position < len(self):
            raise IndexError(f"frame {index} does not exist, the job has {len(self)} frames")
        return position


def read_description(description: Mapping[str, Any] | str | os.PathLike[str]) -> str:
    """Return the JSON text of a mapping, or of the file at a path."""
    if isinstance(description, Mapping):
        return json.dumps(_plain(description))
    return Path(description).read_text(encoding="utf-8")


def _list_presets(value: Any) -> list[str]:
    """Return the names of all presets in a part of a description."""
    if isinstance(value, list):
        return [name for item in value for name in _list_presets(item)]
    if not isinstance(value, dict):
        return []
    inner = [name for item in value.values() for name in _list_presets(item)]
    return [value["preset"], *inner] if isinstance(value.get("preset"), str) else inner


def _plain(value: Any) -> Any:
    """Turn NumPy's values into JSON's; numbers that JSON cannot write become text, which the check refuses."""
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        return _plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return value
