"""Streams: the pictures of a camera, rendered in water while they arrive."""

from __future__ import annotations

import json
import os
import warnings as _warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fathom import _native
from fathom.arguments import list_paths, read_matrix, read_stamp
from fathom.display import encode_thumbnail, html_table
from fathom.errors import InvalidArgument
from fathom.frame import Artifact
from fathom.job import Job, read_description

Channels = Literal["rgb", "bgr", "rgba", "bgra", "mono"]
"""Order of the samples of a pixel."""

_ENHANCED = "enhanced."
_NOT_APPLIED = ("artifacts", "enhance", "metrics")


class StreamFrame:
    """A rendered frame of a stream. H is the height and W the width in pixels."""

    def __init__(
        self,
        artifacts: Mapping[str, NDArray[Any] | str],
        record: _native.StreamRecord,
        error_bound: float | None,
        elapsed_ms: float,
    ) -> None:
        self.artifacts: dict[str, Artifact] = {
            kind: json.loads(value) if isinstance(value, str) else value for kind, value in artifacts.items()
        }
        """All artifacts by kind: the picture, the range, every enhancement, and the others of the job."""
        self.error_bound = error_bound
        """Bound on the error of the exposed light up to white; `None` if the job has no tolerance."""
        self.elapsed_ms = elapsed_ms
        """Milliseconds from the call of the renderer to its result."""
        self._record = record

    def __repr__(self) -> str:
        return f"<fathom.StreamFrame {self.elapsed_ms:.1f} ms: {', '.join(self.artifacts)}>"

    def _repr_png_(self) -> bytes:
        return encode_thumbnail(self.rgb)

    def _repr_html_(self) -> str:
        rows = {"ms": f"{self.elapsed_ms:.1f}", "error bound": self.error_bound, "warnings": "; ".join(self.warnings)}
        return html_table("Frame of a stream", rows, png=self._repr_png_())

    def __getitem__(self, kind: str) -> Artifact:
        try:
            return self.artifacts[kind]
        except KeyError:
            present = ", ".join(self.artifacts)
            raise KeyError(f"the frame has no `{kind}` but {present}: name it in `artifacts` of the job") from None

    def __contains__(self, kind: str) -> bool:
        return kind in self.artifacts

    @property
    def rgb(self) -> NDArray[Any]:
        """The picture: sRGB codes, (H, W, 3); uint8, or uint16 with `camera.bits` 16."""
        picture = self.artifacts["rgb"]
        assert isinstance(picture, np.ndarray)
        return picture

    @property
    def range_m(self) -> NDArray[np.float32] | None:
        """Range along the ray in meters: float32, (H, W), NaN without a return; `None` without distances."""
        meters = self.artifacts.get("range")
        assert meters is None or isinstance(meters, np.ndarray)
        return meters

    @property
    def enhanced(self) -> dict[str, NDArray[np.uint8]]:
        """The result of every enhancement by its name: uint8, (H, W, 3)."""
        return {
            kind.removeprefix(_ENHANCED): picture
            for kind, picture in self.artifacts.items()
            if kind.startswith(_ENHANCED) and isinstance(picture, np.ndarray)
        }

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the frame, such as skipped stages."""
        return tuple(self._record.warnings)

    @cached_property
    def record(self) -> dict[str, Any]:
        """Everything known about the picture: resolved parameters, water, plan, times of stages, warnings."""
        result: dict[str, Any] = json.loads(self._record.text())
        return result

    @property
    def plan(self) -> list[dict[str, Any]]:
        """Every stage with its variant, error bound, gain and expected cost in ms; see `fathom.plan`."""
        plan: list[dict[str, Any]] = self.record["plan"]
        return plan


class Stream:
    """A job over the pictures of a camera: arrays in, arrays out; nothing is stored.

    Kernels, style networks and camera maps persist between frames. Other threads of Python run while a frame renders;
    a stream renders one frame at a time. The same job, arrays and stamps give the same bytes.
    """

    def __init__(
        self,
        job: Job | Mapping[str, Any] | str | os.PathLike[str],
        *,
        vary: Literal["stream", "frame"] = "stream",
        deadline_ms: float | None = None,
        metrics: bool = False,
        styles: str | os.PathLike[str] | None = None,
        onnxruntime: str | os.PathLike[str] | None = None,
    ) -> None:
        """Open a stream with a `Job`, a mapping, or the path of a JSON file.

        The pictures of the stream replace the `scene` of the job, which may be absent. `vary`: "stream" draws the
        random distributions of the job once, "frame" for each frame from its stamp. `deadline_ms` selects, on this
        machine, the most accurate plan that is expected to meet it; a late frame has a warning. `metrics=True` measures
        the metrics of the job. `styles` and `onnxruntime` as for `Job`. Raises `InvalidJob` with every error of the
        description.
        """
        places = list_paths(styles, onnxruntime)
        if isinstance(job, Job):
            if places != (None, None):
                raise InvalidArgument("`styles` and `onnxruntime` belong to the job; give them to `fathom.Job`")
            text, places = job.canonical, job.places
        else:
            text = read_description(job)
        self._native = _native.Stream(text, vary, metrics, deadline_ms, *places)
        for warning in self.warnings:
            _warnings.warn(warning, stacklevel=2)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the job."""
        return tuple(self._native.warnings)

    def __call__(
        self,
        rgb: NDArray[Any],
        *,
        z_depth: NDArray[Any] | None = None,
        range_m: NDArray[Any] | None = None,
        camera: ArrayLike | None = None,
        stamp_ns: int | None = None,
        pose: ArrayLike | None = None,
        channels: Channels = "rgb",
    ) -> StreamFrame:
        """Render a frame.

        `rgb`: uint8 sRGB codes or float32 linear light in the order `channels`, (H, W) for "mono". `z_depth` (along the
        optical axis) or `range_m` (along the ray): float32 meters or uint16 millimeters, (H, W); NaN, infinity, 0 and
        negative values are pixels without a return. Without distances, the stages of the water are skipped. `camera`:
        the matrix [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] in pixels. `stamp_ns`: the time of the picture, by default the
        number of frames so far. `pose`: the 4×4 matrix from camera axes (right, down, ahead) to a world whose z axis
        points up; snow, turbidity and caustics keep their places in it. Arrays may have any strides.

        Raises `InvalidArgument`, a `ValueError`, for wrong arguments, and `RenderError`. The stream continues after an
        error.
        """
        if z_depth is not None and range_m is not None:
            raise InvalidArgument("`z_depth` and `range_m` are both given; give the one that was measured")
        depth: tuple[str, NDArray[Any]] | None = None
        if z_depth is not None:
            depth = ("z_depth", z_depth)
        elif range_m is not None:
            depth = ("range_m", range_m)
        artifacts, record, error_bound, elapsed_ms = self._native.render(
            rgb,
            channels,
            depth,
            read_matrix("camera", camera, 3),
            read_stamp(stamp_ns),
            read_matrix("pose", pose, 4),
        )
        return StreamFrame(dict(artifacts), record, error_bound, elapsed_ms)


def apply(
    rgb: NDArray[Any],
    *,
    range_m: NDArray[Any] | None = None,
    z_depth: NDArray[Any] | None = None,
    water: str | Mapping[str, Any] | None = None,
    lights: Sequence[Mapping[str, Any]] = (),
    camera: ArrayLike | None = None,
    channels: Channels = "rgb",
    **fields: Any,
) -> NDArray[Any]:
    """Return one picture in water.

    `water` is the name of an optical water such as "jerlov-3C", or the `water` of a job; `lights` and `fields` are
    those of a job, such as `alpha=0.5`, `site="harbour-wall"` or `seed=3`. The other arguments are those of a
    `Stream`, which renders many pictures faster and also returns `enhance`, `artifacts` and `metrics`. Fields without
    effect, such as water without distances, come with a warning.
    """
    for name in _NOT_APPLIED:
        if fields.get(name):
            _warnings.warn(f"`{name}` does not change the picture; use `fathom.Stream` for it", stacklevel=2)
    job: dict[str, Any] = dict(fields)
    if water is not None:
        job["water"] = {"optics": water} if isinstance(water, str) else water
    if lights:
        job["lights"] = list(lights)
    frame = Stream(job)(rgb, z_depth=z_depth, range_m=range_m, camera=camera, channels=channels)
    for warning in frame.warnings:
        _warnings.warn(warning, stacklevel=2)
    return frame.rgb
