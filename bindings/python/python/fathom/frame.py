"""One frame as arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cached_property
from typing import Any, TypeAlias, TypeGuard

import numpy as np
from numpy.typing import NDArray

from fathom.display import encode_thumbnail, html_table

Artifact: TypeAlias = "NDArray[Any] | dict[str, Any]"
"""An array, or the JSON object of `boxes`."""


class Frame:
    """One frame: its artifacts as arrays, and its record.

    `frame["rgb"]` is the artifact of this kind; the usual ones have attributes. H is the height and W the width
    in pixels.
    """

    def __init__(self, index: int, artifacts: Mapping[str, NDArray[Any] | str], record: str) -> None:
        self.index = index
        """Position in the job, from 0."""
        self._artifacts: dict[str, Artifact] = {
            kind: json.loads(value) if isinstance(value, str) else value for kind, value in artifacts.items()
        }
        self._record = record

    def __repr__(self) -> str:
        return f"<fathom.Frame {self.index}: {', '.join(self._artifacts)}>"

    def _repr_png_(self) -> bytes | None:
        """Return a thumbnail of the first picture, `None` without one."""
        pictures = (value for value in self._artifacts.values() if _is_picture(value))
        picture = next(pictures, None)
        return None if picture is None else encode_thumbnail(picture)

    def _repr_html_(self) -> str:
        return html_table(
            f"Frame {self.index}",
            {kind: _describe_artifact(value) for kind, value in self._artifacts.items()},
            png=self._repr_png_(),
        )

    def __getitem__(self, kind: str) -> Artifact:
        try:
            return self._artifacts[kind]
        except KeyError:
            there = ", ".join(self._artifacts) or "nothing"
            raise KeyError(f"frame {self.index} has no `{kind}` but {there}: name it in `kinds`") from None

    def __contains__(self, kind: str) -> bool:
        return kind in self._artifacts

    def _array(self, kind: str) -> NDArray[Any]:
        value = self[kind]
        assert isinstance(value, np.ndarray)
        return value

    @property
    def artifacts(self) -> dict[str, Artifact]:
        """All artifacts by kind."""
        return dict(self._artifacts)

    @cached_property
    def record(self) -> dict[str, Any]:
        """Everything known about the image: resolved parameters, water, plan, measurements, warnings, provenance."""
        result: dict[str, Any] = json.loads(self._record)
        return result

    @property
    def rgb(self) -> NDArray[np.uint8]:
        """The picture: uint8 sRGB codes, (H, W, 3)."""
        return self._array("rgb")

    @property
    def clean(self) -> NDArray[np.uint8]:
        """The scene in air: uint8 sRGB codes, (H, W, 3)."""
        return self._array("clean")

    @property
    def range_m(self) -> NDArray[np.float32]:
        """Range along the ray in meters: float32, (H, W); NaN in open water."""
        return self._array("range")

    @property
    def semantics(self) -> NDArray[np.uint8]:
        """Category of each pixel: uint8, (H, W)."""
        return self._array("semantics")

    @property
    def visible_semantics(self) -> NDArray[np.uint8]:
        """`semantics`, with background where the water transmits less than 2 % in every channel: uint8, (H, W)."""
        return self._array("semantics.visible")

    @property
    def instances(self) -> NDArray[np.uint16]:
        """Instance of each pixel: uint16, (H, W); 0 is the background."""
        return self._array("instances")

    @property
    def normals(self) -> NDArray[np.float32]:
        """Unit normals in camera axes (right, down, ahead): float32, (H, W, 3); 0 in open water."""
        return self._array("normals")

    @property
    def rgb_right(self) -> NDArray[np.uint8]:
        """The picture of the right camera: uint8 sRGB codes, (H, W, 3)."""
        return self._array("rgb_right")

    @property
    def flow(self) -> NDArray[np.float32]:
        """Motion to the next frame in x and y, and visibility there, 1 or 0: float32, (H, W, 3), in pixels."""
        return self._array("flow")

    @property
    def disparity(self) -> NDArray[np.float32]:
        """Position minus that in `rgb_right`, and visibility there, 1 or 0: float32, (H, W, 3), in pixels."""
        return self._array("disparity")

    @property
    def transmittance(self) -> NDArray[np.float32]:
        """Share of the direct light that arrives, by band: float32 in 0..1, (H, W, 3)."""
        return self._array("transmittance")

    @property
    def boxes(self) -> list[dict[str, Any]]:
        """The objects in view: number, category, bounds (left, top, right, bottom in pixels), range, visibility."""
        boxes = self["boxes"]
        assert isinstance(boxes, dict)
        instances: list[dict[str, Any]] = boxes["instances"]
        return instances


def _is_picture(value: Artifact) -> TypeGuard[NDArray[Any]]:
    return isinstance(value, np.ndarray) and value.dtype in (np.uint8, np.uint16) and value.ndim == 3


def _describe_artifact(value: Artifact) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {'×'.join(map(str, value.shape))}"
    instances = value.get("instances")
    return f"{len(instances)} objects" if isinstance(instances, list) else "JSON"
