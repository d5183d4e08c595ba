"""The settings of the node itself, apart from the job."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fathom.errors import InvalidArgument

MODES = ("water", "enhance", "water+enhance")
QUALITIES = ("sensor_data", "reliable")
TRANSPORTS = ("raw", "compressed")


def _describe(default: Any, meaning: str, **limits: Any) -> Any:
    return field(default=default, metadata={"meaning": meaning, **limits})


@dataclass(frozen=True)
class Settings:
    """Settings with their defaults; metadata holds the meaning, the limits, and whether they are fixed at start."""

    job: str = _describe("", "path of the JSON file with the job; a change replaces all fields of the job")
    site: str = _describe("", "site that the job starts from; a change replaces all fields of the job")
    mode: str = _describe("water", "results that are rendered and published", names=MODES)
    use_depth: bool = _describe(True, "whether pictures wait for a depth; without it they get no water")
    use_camera_info: bool = _describe(True, "whether the camera comes from `camera_info`, else from camera.hfov_deg")
    rectified: bool = _describe(False, "whether the pictures are rectified: the camera is P, not K, of `camera_info`")
    slop_s: float = _describe(0.02, "largest difference of the stamps of picture and depth", least=0, most=10)
    depth_wait_s: float = _describe(1.0, "lag of the depth after which a picture is dropped", least=0, most=60)
    deadline_ms: float = _describe(0.0, "time of a frame that selects the plan; 0 for none", least=0, most=1e6)
    vary: str = _describe("stream", "when random distributions are drawn", names=("stream", "frame"))
    jpeg_quality: int = _describe(90, "quality of ~/image/compressed", least=1, most=100)
    world_frame: str = _describe("", "frame of /tf with z up in which snow keeps its place; empty for no poses")
    optical_frame: str = _describe("", "frame of the camera in /tf; empty for the `frame_id` of the pictures")
    qos: str = _describe("sensor_data", "quality of service of pictures and depths", names=QUALITIES, fixed=True)
    image_transport: str = _describe("raw", "transport of `image`", names=TRANSPORTS, fixed=True)
    depth_transport: str = _describe(
        "raw", "transport of `depth`: compressed is compressedDepth", names=TRANSPORTS, fixed=True
    )
    styles: str = _describe("", "folder of more style models", fixed=True)
    onnxruntime: str = _describe("", "library file of ONNX Runtime", fixed=True)

    @property
    def needs_depth(self) -> bool:
        """Whether pictures wait for a depth."""
        return self.use_depth and self.mode != "enhance"

    @property
    def needs_camera_info(self) -> bool:
        """Whether pictures need a `camera_info`; enhancement passes it on if there is one."""
        return self.use_camera_info and self.mode != "enhance"


NAMES = tuple(entry.name for entry in dataclasses.fields(Settings))
"""Names of all settings."""
FIXED = tuple(entry.name for entry in dataclasses.fields(Settings) if entry.metadata.get("fixed"))
"""Names of the settings that cannot change while the node runs."""


def read_settings(values: Mapping[str, Any], before: Settings | None = None) -> Settings:
    """Return the settings with these values in place of the defaults, or of those before.

    Raises `InvalidArgument` for a wrong type or value, and for a change of a fixed setting.
    """
    checked = {}
    for entry in dataclasses.fields(Settings):
        if entry.name in values:
            checked[entry.name] = _check(entry, values[entry.name])
            if before and entry.name in FIXED and checked[entry.name] != getattr(before, entry.name):
                raise InvalidArgument(f"`{entry.name}` cannot change while the node runs; restart the node with it")
    return dataclasses.replace(before or Settings(), **checked)


def _check(entry: dataclasses.Field[Any], value: Any) -> Any:
    kind: type[Any] = type(entry.default)
    checked: Any = value
    if kind is float and type(value) is int:
        checked = float(value)
    if type(checked) is not kind:
        raise InvalidArgument(f"`{entry.name}` is {value!r}; must be of the type {_TYPES[kind]}")
    limits: Mapping[str, Any] = entry.metadata
    names, least, most = (limits.get(limit) for limit in ("names", "least", "most"))
    if names and checked not in names:
        raise InvalidArgument(f'`{entry.name}` is "{value}"; must be {", ".join(names)}')
    if least is not None and not (math.isfinite(checked) and least <= checked <= most):
        raise InvalidArgument(f"`{entry.name}` is {value}; must be {least} to {most:g}")
    return checked


_TYPES = {str: "string", bool: "bool", int: "integer", float: "double"}
