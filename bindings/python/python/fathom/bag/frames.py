"""The frames of a recording: pictures with the depth, camera and pose of their stamp."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Connection

from fathom.bag.errors import BagError
from fathom.bag.poses import NoPose, Poses
from fathom.bag.recording import Recording
from fathom.bag.report import Report, format_stamp
from fathom.bag.topics import Topics
from fathom.messages.cameras import has_distortion, read_camera
from fathom.messages.errors import MessageError
from fathom.messages.images import Picture, has_distance, read_depth, read_picture, read_stamp
from fathom.messages.pairing import Pair, Pairing


@dataclass(frozen=True)
class Frame:
    """A picture with what belongs to its stamp."""

    stamp_ns: int
    recorded_ns: int
    header: Any
    picture: Picture
    z_depth: NDArray[Any] | None
    camera: NDArray[np.float64] | None
    pose: NDArray[np.float64] | None


@dataclass(frozen=True)
class Timed:
    """A message with its time of recording."""

    recorded_ns: int
    message: Any


class Frames:
    """Makes frames of messages as they come. A frame without a usable input is left out and reported."""

    def __init__(
        self, recording: Recording, topics: Topics, poses: Poses | None, report: Report, slop_ns: int, stamps: str
    ) -> None:
        """`stamps` is "header", or "recorded" for images whose headers have no times."""
        self._recording = recording
        self._topics = topics
        self._poses = poses
        self._report = report
        self._slop_ns = slop_ns
        self._uses_header = stamps == "header"
        self._pairing: Pairing[Timed, Timed] = Pairing(slop_ns)
        self._newest_ns: int | None = None
        self._info = self._read_first_info()
        if self._info is not None and has_distortion(self._info) and not topics.rectified:
            report.note(
                f"note: {topics.camera_info} has distortion, which is not used; give a rectified image and "
                "--rectified, or set `camera.distortion` in the job"
            )

    def add(self, connection: Connection, recorded_ns: int, data: bytes) -> Iterator[Frame]:
        """Take a message of any topic and yield the frames that are complete."""
        if connection.topic not in (self._topics.image, self._topics.depth, self._topics.camera_info):
            return
        try:
            message = self._recording.deserialize(connection, data)
        except MessageError as error:
            self._report.leave_out(recorded_ns, f"{error.topic}: {error.kind}", str(error))
            return
        timed = Timed(recorded_ns, message)
        if connection.topic == self._topics.camera_info:
            self._info = message
        elif connection.topic == self._topics.depth:
            yield from self._add_depth(timed)
        else:
            yield from self._add_image(timed)

    def finish(self) -> Iterator[Frame]:
        """Yield the frames that waited for a depth when the recording ended."""
        yield from self._complete(self._pairing.flush())
        if self._pairing.unused_depths:
            self._report.note(f"note: {self._pairing.unused_depths} depths of {self._topics.depth} belong to no image")

    def _read_first_info(self) -> Any:
        """Return the first camera info: images may be recorded before it."""
        if self._topics.camera_info is None:
            return None
        connections = self._recording.find(self._topics.camera_info)
        for connection, _, data in self._recording.messages(connections):
            return self._recording.deserialize(connection, data)
        raise BagError(f"{self._topics.camera_info} has no message; leave --camera-info out or give another topic")

    def _add_image(self, timed: Timed) -> Iterator[Frame]:
        topic = self._topics.image
        try:
            stamp_ns = self._read_stamp(timed, topic)
        except MessageError as error:
            self._report.leave_out(timed.recorded_ns, f"{topic}: {error.kind}", str(error))
            return
        if stamp_ns == self._newest_ns:
            reason = "`header.stamp` is that of the image before; give --stamps recorded if headers have no times"
            self._report.leave_out(stamp_ns, f"{topic}: repeated stamp", f"{topic}: {reason}")
            return
        self._newest_ns = stamp_ns
        if self._topics.depth is None:
            yield from self._complete([Pair(stamp_ns, timed, None, None)])
        else:
            yield from self._complete(self._pairing.add_image(stamp_ns, timed))

    def _add_depth(self, timed: Timed) -> Iterator[Frame]:
        assert self._topics.depth is not None
        try:
            stamp_ns = self._read_stamp(timed, self._topics.depth)
        except MessageError as error:
            self._report.note(f"depth left out: {error}")
            return
        yield from self._complete(self._pairing.add_depth(stamp_ns, timed))

    def _read_stamp(self, timed: Timed, topic: str) -> int:
        return read_stamp(timed.message, topic) if self._uses_header else timed.recorded_ns

    def _complete(self, pairs: list[Pair[Timed, Timed]]) -> Iterator[Frame]:
        for pair in pairs:
            try:
                yield self._make_frame(pair)
            except MessageError as error:
                self._report.leave_out(pair.stamp_ns, f"{error.topic}: {error.kind}", str(error))
            except NoPose as error:
                self._report.leave_out(pair.stamp_ns, "no pose", str(error))

    def _make_frame(self, pair: Pair[Timed, Timed]) -> Frame:
        message = pair.image.message
        picture = read_picture(message, self._topics.image)
        height, width = picture.rgb.shape[:2]
        camera = None
        if self._topics.camera_info is not None:
            camera = read_camera(
                self._info, (width, height), self._topics.camera_info, rectified=self._topics.rectified
            )
        depth = None if self._topics.depth is None else self._read_depth(pair, self._topics.depth, (height, width))
        pose = None if self._poses is None else self._poses.find(pair.stamp_ns, message.header.frame_id)
        return Frame(pair.stamp_ns, pair.image.recorded_ns, message.header, picture, depth, camera, pose)

    def _read_depth(self, pair: Pair[Timed, Timed], topic: str, shape: tuple[int, ...]) -> NDArray[Any]:
        if pair.depth is None:
            raise MessageError(topic, self._describe_missing_depth(pair.offset_ns), "no depth")
        depth = read_depth(pair.depth.message, topic)
        if depth.shape != shape:
            sizes = f"the depth is {depth.shape[1]}×{depth.shape[0]} but the image {shape[1]}×{shape[0]}"
            raise MessageError(topic, f"{sizes}; register it to the image and resample it to its size", "size")
        if not has_distance(depth):
            reason = f"{topic}: no pixel has a distance above 0; all are rendered as open water"
            self._report.warn(pair.stamp_ns, f"{topic}: no pixel with a distance", reason)
        return depth

    def _describe_missing_depth(self, offset_ns: int | None) -> str:
        limit = f"no depth within {self._slop_ns / 1e9:g} s (--slop-s)"
        if offset_ns is None:
            return f"{limit}, nor any other"
        return f"{limit}; the nearest is {format_stamp(abs(offset_ns))} s {'later' if offset_ns > 0 else 'earlier'}"
