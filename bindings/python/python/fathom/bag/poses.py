"""Poses of the camera at the stamps of its images, from transforms or from a topic with poses."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from fathom.bag.errors import BagError
from fathom.bag.recording import TRANSFORMS, Recording
from fathom.bag.topics import require_type
from fathom.bag.track import NoPose, Track
from fathom.messages.images import read_stamp

__all__ = ["NoPose", "Poses", "TopicPoses", "TransformPoses", "find_fixed_transform"]

POSE_TYPES = (
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "nav_msgs/msg/Odometry",
)
_BODY_FROM_OPTICAL = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""From axes right, down, ahead to axes ahead, left, up."""


class Poses(Protocol):
    """Where a camera was."""

    def find(self, stamp_ns: int, frame_id: str) -> NDArray[np.float64]:
        """Return the matrix from camera axes (right, down, ahead) to the world; raises `NoPose`."""


class TopicPoses:
    """Poses of a topic with `PoseStamped`, `PoseWithCovarianceStamped` or `Odometry`."""

    def __init__(self, recording: Recording, topic: str, axes: str) -> None:
        """`axes` of the poses: "optical" (right, down, ahead) or "body" (ahead, left, up)."""
        connections = require_type(recording, "--pose-topic", topic, POSE_TYPES)
        self._track = Track(topic)
        self._is_body = axes == "body"
        for connection, _, data in recording.messages(connections):
            message = recording.deserialize(connection, data)
            # Messages with covariance have the pose one level deeper.
            pose = message.pose.pose if hasattr(message.pose, "pose") else message.pose
            self._track.add(read_stamp(message, topic), pose.position, pose.orientation)

    def find(self, stamp_ns: int, frame_id: str) -> NDArray[np.float64]:
        """Return the matrix from camera axes to the world; raises `NoPose`."""
        del frame_id
        matrix = self._track.interpolate(stamp_ns)
        return matrix @ _BODY_FROM_OPTICAL if self._is_body else matrix


def find_fixed_transform(recording: Recording, source: str, target: str) -> NDArray[np.float64]:
    """Return the matrix from the axes of one frame to those of another, from static transforms; raises `BagError`."""
    steps: dict[str, tuple[str, NDArray[np.float64]]] = {}
    connections = [each for each in recording.connections if each.msgtype == TRANSFORMS]
    for connection, _, data in recording.messages([each for each in connections if each.topic.endswith("static")]):
        for transform in recording.deserialize(connection, data).transforms:
            parent, child = transform.header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
            track = Track(f"{connection.topic} from {child} to {parent}")
            track.add(0, transform.transform.translation, transform.transform.rotation)
            steps[child] = (parent, track.interpolate(0))
    above_source, above_target = (_list_above(frame.lstrip("/"), steps) for frame in (source, target))
    for frame, to_frame in above_source.items():
        if frame in above_target:
            return np.linalg.inv(above_target[frame]) @ to_frame
    raise BagError(f"no topic of static transforms leads from the frame {source!r} to {target!r}")


def _list_above(frame: str, steps: dict[str, tuple[str, NDArray[np.float64]]]) -> dict[str, NDArray[np.float64]]:
    """Return a frame and those above it, nearest first, with the matrices from its axes to theirs."""
    above, matrix = {frame: np.eye(4)}, np.eye(4)
    while frame in steps and steps[frame][0] not in above:
        frame, step = steps[frame]
        matrix = step @ matrix
        above[frame] = matrix
    return above


class TransformPoses:
    """Poses of `/tf` and `/tf_static`, from the frame of an image to a world."""

    def __init__(self, recording: Recording, world: str) -> None:
        self._world = world.lstrip("/")
        self._fixed: dict[str, tuple[str, NDArray[np.float64]]] = {}
        self._moving: dict[str, tuple[str, Track]] = {}
        connections = [each for each in recording.connections if each.msgtype == TRANSFORMS]
        if not connections:
            raise BagError(f"{recording.path} has no topic of {TRANSFORMS}; --world needs /tf, else give --pose-topic")
        for connection, _, data in recording.messages(connections):
            for transform in recording.deserialize(connection, data).transforms:
                self._add(transform, connection.topic)
        frames = self._list_frames()
        if self._world not in frames:
            raise BagError(f"--world {world} is no frame of the transforms; they have {', '.join(sorted(frames))}")

    def find(self, stamp_ns: int, frame_id: str) -> NDArray[np.float64]:
        """Return the matrix from the axes of a frame to the world; raises `NoPose`."""
        matrix = np.eye(4)
        frame, passed = frame_id.lstrip("/"), set[str]()
        while frame != self._world:
            if frame in passed or (frame not in self._fixed and frame not in self._moving):
                chain = f"`frame_id` {frame_id!r} leads to {frame!r}, but not to {self._world!r}"
                raise NoPose(f"{chain}; the transforms have {', '.join(sorted(self._list_frames()))}")
            passed.add(frame)
            if frame in self._fixed:
                frame, step = self._fixed[frame]
            else:
                frame, track = self._moving[frame]
                step = track.interpolate(stamp_ns)
            matrix = step @ matrix
        return matrix

    def _add(self, transform: Any, topic: str) -> None:
        child, parent = transform.child_frame_id.lstrip("/"), transform.header.frame_id.lstrip("/")
        translation, rotation = transform.transform.translation, transform.transform.rotation
        if topic.endswith("static"):
            fixed = Track(f"{topic} from {child} to {parent}")
            fixed.add(0, translation, rotation)
            self._fixed[child] = (parent, fixed.interpolate(0))
            return
        known = self._moving.setdefault(child, (parent, Track(f"{topic} from {child} to {parent}")))
        if known[0] != parent:
            raise BagError(f"{topic}: the frame {child} has the parents {known[0]} and {parent}; must be one")
        known[1].add(read_stamp(transform, topic), translation, rotation)

    def _list_frames(self) -> set[str]:
        parents = {parent for parent, _ in [*self._fixed.values(), *self._moving.values()]}
        return parents | set(self._fixed) | set(self._moving)
