"""The topics that a command reads, checked against a recording."""

from __future__ import annotations

from dataclasses import dataclass

from rosbags.interfaces import Connection

from fathom.bag.errors import BagError
from fathom.bag.recording import Recording

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"


@dataclass(frozen=True)
class Topics:
    """The topics of a camera."""

    image: str
    depth: str | None = None
    camera_info: str | None = None
    rectified: bool = False
    """Whether the pictures are rectified: the camera is P, not K, of the camera info."""

    def check(self, recording: Recording) -> None:
        """Raise `BagError` for a topic that the recording does not have, or of another type."""
        require_type(recording, "--image", self.image, (IMAGE, COMPRESSED))
        if self.depth is not None:
            require_type(recording, "--depth", self.depth, (IMAGE, COMPRESSED))
        if self.camera_info is not None:
            require_type(recording, "--camera-info", self.camera_info, (CAMERA_INFO,))
        if self.rectified and self.camera_info is None:
            raise BagError("--rectified needs --camera-info")
        if self.depth == self.image:
            raise BagError(f"--image and --depth are both {self.image}; give the topic of the depths")

    def list_unused_camera_info(self, recording: Recording) -> list[str]:
        """Return topics of camera info next to the image, if none is given."""
        if self.camera_info is not None:
            return []
        place = self.image.removesuffix("/compressed").rpartition("/")[0]
        connections = recording.connections
        return [
            each.topic for each in connections if each.msgtype == CAMERA_INFO and each.topic.startswith(f"{place}/")
        ]


def require_type(recording: Recording, option: str, topic: str, types: tuple[str, ...]) -> list[Connection]:
    """Return the connections of a topic; raises `BagError` if one is of another type."""
    found = recording.find(topic)
    for connection in found:
        if connection.msgtype not in types:
            raise BagError(f"{option} {topic} is {connection.msgtype}; must be {' or '.join(types)}")
    return found
