"""Small recordings of the three kinds, with the topics of a camera."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HEIGHT, WIDTH = 24, 32
START_NS = 1_700_000_000_000_000_000
STEP_NS = 100_000_000
IMAGE, DEPTH, INFO, NOTE, POSE = "/cam/image", "/cam/depth", "/cam/camera_info", "/note", "/odometry"
KINDS = {"ros1": "dive.bag", "sqlite": "dive", "mcap": "dive_mcap"}
_QOS = Qos(
    QosHistory.KEEP_LAST,
    7,
    QosReliability.BEST_EFFORT,
    QosDurability.TRANSIENT_LOCAL,
    QosTime(1, 2),
    QosTime(3, 4),
    QosLiveliness.AUTOMATIC,
    QosTime(5, 6),
    False,
)


def make_pixels(number: int) -> NDArray[np.uint8]:
    return np.random.default_rng(number).integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8)


def make_depth() -> NDArray[np.float32]:
    return np.linspace(0.8, 4, HEIGHT * WIDTH, dtype=np.float32).reshape(HEIGHT, WIDTH)


class Recorder:
    """Writes messages of a camera."""

    def __init__(self, folder: Path, kind: str) -> None:
        self.path = folder / KINDS[kind]
        self.is_ros1 = kind == "ros1"
        self.store = get_typestore(Stores.ROS1_NOETIC if self.is_ros1 else Stores.ROS2_HUMBLE)
        if self.is_ros1:
            transforms = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(transforms, "tf2_msgs/msg/TFMessage"))
        plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
        self.writer: Any = (
            Ros1Writer(self.path) if self.is_ros1 else Ros2Writer(self.path, version=8, storage_plugin=plugin)
        )
        self.connections: dict[str, Any] = {}

    def __enter__(self) -> Recorder:
        self.writer.open()
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()

    def make(self, msgtype: str, **fields: Any) -> Any:
        return self.store.types[msgtype](**fields)

    def header(self, stamp_ns: int, frame_id: str = "camera") -> Any:
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        number = {"seq": 5} if self.is_ros1 else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id, **number)

    def write(self, topic: str, recorded_ns: int, message: Any) -> None:
        msgtype = message.__msgtype__
        if topic not in self.connections:
            extra = {} if self.is_ros1 else {"offered_qos_profiles": [_QOS]}
            self.connections[topic] = self.writer.add_connection(topic, msgtype, typestore=self.store, **extra)
        serialize = self.store.serialize_ros1 if self.is_ros1 else self.store.serialize_cdr
        self.writer.write(self.connections[topic], recorded_ns, serialize(message, msgtype))

    def image(self, topic: str, stamp_ns: int, encoding: str, pixels: NDArray[Any], **changes: Any) -> None:
        """Write an image 1 ms after its stamp."""
        height, width = pixels.shape[:2]
        data = np.ascontiguousarray(pixels).reshape(-1).view(np.uint8)
        fields: dict[str, Any] = {"height": height, "width": width, "encoding": encoding, "is_bigendian": 0}
        fields |= {"step": data.size // height, "data": data} | changes
        message = self.make("sensor_msgs/msg/Image", header=self.header(stamp_ns), **fields)
        self.write(topic, stamp_ns + 1_000_000, message)

    def info(self, stamp_ns: int, width: int = WIDTH, height: int = HEIGHT) -> None:
        region = self.make(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        matrices = {
            "d": np.zeros(0),
            "k": np.array([30.0, 0, 15.5, 0, 30, 11.5, 0, 0, 1]),
            "r": np.eye(3).reshape(-1),
            "p": np.zeros(12),
        }
        named = {name.upper() if self.is_ros1 else name: matrix for name, matrix in matrices.items()}
        message = self.make(
            "sensor_msgs/msg/CameraInfo",
            header=self.header(stamp_ns),
            height=height,
            width=width,
            distortion_model="plumb_bob",
            binning_x=0,
            binning_y=0,
            roi=region,
            **named,
        )
        self.write(INFO, stamp_ns, message)

    def note(self, stamp_ns: int, text: str) -> None:
        self.write(NOTE, stamp_ns, self.make("std_msgs/msg/String", data=text))

    def odometry(self, stamp_ns: int, x: float) -> None:
        point = self.make("geometry_msgs/msg/Point", x=x, y=2.0, z=-3.0)
        turn = self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        pose = self.make("geometry_msgs/msg/Pose", position=point, orientation=turn)
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        twist = self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero)
        message = self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(stamp_ns, "map"),
            child_frame_id="base_link",
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=pose, covariance=np.zeros(36)),
            twist=self.make("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )
        self.write(POSE, stamp_ns, message)

    def imu(
        self, topic: str, stamp_ns: int, turn: tuple[float, ...], push: tuple[float, ...], first_covariance: float = 0
    ) -> None:
        """Write an angular velocity and an acceleration."""
        vector = "geometry_msgs/msg/Vector3"
        covariance = np.zeros(9)
        covariance[0] = first_covariance
        message = self.make(
            "sensor_msgs/msg/Imu",
            header=self.header(stamp_ns, "imu"),
            orientation=self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
            orientation_covariance=np.zeros(9),
            angular_velocity=self.make(vector, x=turn[0], y=turn[1], z=turn[2]),
            angular_velocity_covariance=covariance,
            linear_acceleration=self.make(vector, x=push[0], y=push[1], z=push[2]),
            linear_acceleration_covariance=np.zeros(9),
        )
        self.write(topic, stamp_ns + 2_000_000, message)

    def transform(self, topic: str, stamp_ns: int, parent: str, child: str, place: tuple[float, float, float]) -> None:
        translation = self.make("geometry_msgs/msg/Vector3", x=place[0], y=place[1], z=place[2])
        turn = self.make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        transform = self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(stamp_ns, parent),
            child_frame_id=child,
            transform=self.make("geometry_msgs/msg/Transform", translation=translation, rotation=turn),
        )
        self.write(topic, stamp_ns, self.make("tf2_msgs/msg/TFMessage", transforms=[transform]))


def record_dive(folder: Path, kind: str, frames: int = 3) -> Path:
    """Write a recording whose images and depths have equal stamps."""
    with Recorder(folder, kind) as recorder:
        for number in range(frames):
            stamp_ns = START_NS + number * STEP_NS
            recorder.info(stamp_ns)
            recorder.image(IMAGE, stamp_ns, "rgb8", make_pixels(number))
            recorder.image(DEPTH, stamp_ns, "32FC1", make_depth())
            recorder.note(stamp_ns, f"number {number}")
    return recorder.path
