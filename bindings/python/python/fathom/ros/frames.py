"""A pair of messages on its way through the stream."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.errors import FathomError
from fathom.messages.cameras import read_camera
from fathom.messages.images import has_distance, read_depth, read_picture
from fathom.messages.pairing import Pair
from fathom.ros.diagnostics import Topics
from fathom.ros.settings import Settings
from fathom.ros.transforms import Transforms
from fathom.stream import Stream, StreamFrame

_POSE_WAIT_S = 0.2
"""Time that a picture waits for the transforms of its stamp, which usually arrive after it."""


class NoCamera(FathomError):
    """A picture before the first `camera_info`."""


@dataclass(frozen=True)
class Rendered:
    """A rendered picture, with the times of its parts."""

    frame: StreamFrame
    header: Any
    camera_info: Any | None
    warnings: tuple[str, ...]
    times_ms: dict[str, float]


class FrameRenderer:
    """Renders pairs of messages with the stream and settings of the moment."""

    def __init__(self, settings: Settings, stream: Stream, topics: Topics, transforms: Transforms) -> None:
        self.camera_info: Any | None = None
        """Newest message about the camera."""
        self._topics = topics
        self._transforms = transforms
        self._lock = threading.Lock()
        self._current = settings, stream

    def replace(self, settings: Settings, stream: Stream) -> None:
        """Use other settings and another stream from the next frame on."""
        with self._lock:
            self._current = settings, stream

    def render(self, pair: Pair[Any, Any]) -> Rendered:
        """Render a pair of messages.

        Raises `MessageError`, `NoCamera`, `NoPose`, and the errors of a `fathom.Stream`.
        """
        with self._lock:
            settings, stream = self._current
        begun, worked = time.perf_counter(), time.thread_time()
        picture = read_picture(pair.image, self._topics.image)
        depth = None if pair.depth is None else read_depth(pair.depth, self._topics.depth)
        warnings = () if depth is None or has_distance(depth) else (self._describe_empty_depth(),)
        info = self._find_camera_info(settings)
        height, width = picture.rgb.shape[:2]
        camera = None
        if info is not None and settings.needs_camera_info:
            camera = read_camera(info, (width, height), self._topics.camera_info, rectified=settings.rectified)
        converted, convert_cpu = time.perf_counter(), time.thread_time() - worked
        pose = self._find_pose(settings, pair)
        posed, worked = time.perf_counter(), time.thread_time()
        frame = stream(
            picture.rgb, z_depth=depth, camera=camera, stamp_ns=pair.stamp_ns, pose=pose, channels=picture.channels
        )
        rendered, render_cpu = time.perf_counter(), time.thread_time() - worked
        times_ms = {
            "conversion": converted - begun,
            "conversion CPU": convert_cpu,
            "pose": posed - converted,
            "chain": rendered - posed,
            "chain CPU": render_cpu,
        }
        milliseconds = {part: 1e3 * spent for part, spent in times_ms.items()}
        return Rendered(frame, pair.image.header, info, (*frame.warnings, *warnings), milliseconds)

    def _describe_empty_depth(self) -> str:
        return f"{self._topics.depth}: no pixel has a distance above 0; all are rendered as open water"

    def _find_camera_info(self, settings: Settings) -> Any | None:
        if not settings.use_camera_info:
            return None
        if self.camera_info is None and settings.needs_camera_info:
            raise NoCamera("no camera_info was received")
        return self.camera_info

    def _find_pose(self, settings: Settings, pair: Pair[Any, Any]) -> NDArray[np.float64] | None:
        if not settings.world_frame:
            return None
        frame = settings.optical_frame or pair.image.header.frame_id
        return self._transforms.find_pose(frame, settings.world_frame, pair.stamp_ns, _POSE_WAIT_S)
