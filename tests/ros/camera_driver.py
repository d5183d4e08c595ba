"""The camera of a simulator: publishes pictures, depths and camera_info in this process, and reads diagnostics."""

import array
import threading
import time
from typing import Any

import numpy as np
import rclpy
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticArray
from drive import pile
from harness import Diagnostics
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

ENCODINGS = {("uint8", 3): "rgb8", ("uint8", 1): "mono8", ("float32", 1): "32FC1", ("uint16", 1): "16UC1"}


def make_stamp(stamp_ns: int) -> Time:
    """Return a time in the form of ROS."""
    return Time(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)


def make_image(pixels: np.ndarray, stamp_ns: int, **fields: Any) -> Image:
    """Return an Image; `fields` replace those of the array."""
    samples = 1 if pixels.ndim == 2 else pixels.shape[2]
    data = array.array("B")
    data.frombytes(np.ascontiguousarray(pixels).tobytes())
    described = {
        "header": Header(stamp=make_stamp(stamp_ns), frame_id="camera_optical"),
        "height": pixels.shape[0],
        "width": pixels.shape[1],
        "encoding": ENCODINGS[pixels.dtype.name, samples],
        "step": pixels.shape[1] * samples * pixels.itemsize,
        "data": data,
    }
    return Image(**(described | fields))


def make_camera_info(size: tuple[int, int], stamp_ns: int) -> CameraInfo:
    """Return the camera_info of pictures of a size."""
    k = pile.make_camera(size).reshape(-1).tolist()
    info = CameraInfo(width=size[0], height=size[1], k=k, distortion_model="plumb_bob", d=[0.0] * 5)
    info.header = Header(stamp=make_stamp(stamp_ns), frame_id="camera_optical")
    return info


class Camera:
    """The topics of a simulator, and the diagnostics of the node."""

    def __init__(self, name: str = "simulator") -> None:
        self.node = rclpy.create_node(name)
        # Reliable; a node with the quality of sensor data receives it without the guarantee.
        quality = QoSProfile(depth=10)
        self._image = self.node.create_publisher(Image, "/camera/image", quality)
        self._depth = self.node.create_publisher(Image, "/camera/depth", quality)
        self._info = self.node.create_publisher(CameraInfo, "/camera/camera_info", quality)
        self.diagnostics = Diagnostics()
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self.diagnostics.take, 10)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._executor.spin, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leave the graph."""
        self._executor.shutdown()
        self._thread.join(5)
        self.node.destroy_node()

    def wait_for_node(self, timeout_s: float = 30) -> None:
        """Wait until the node receives all three topics."""
        until = time.monotonic() + timeout_s
        while any(topic.get_subscription_count() < 1 for topic in (self._image, self._depth, self._info)):
            assert time.monotonic() < until, "the node has not subscribed the topics"
            time.sleep(0.05)

    def publish_info(self, size: tuple[int, int], **fields: Any) -> None:
        """Publish a camera_info; `fields` replace those of the size."""
        info = make_camera_info(size, time.time_ns())
        for name, value in fields.items():
            setattr(info, name, value)
        self._info.publish(info)

    def publish_image(self, pixels: np.ndarray, stamp_ns: int, **fields: Any) -> None:
        """Publish a picture."""
        self._image.publish(make_image(pixels, stamp_ns, **fields))

    def publish_depth(self, meters: np.ndarray, stamp_ns: int, **fields: Any) -> None:
        """Publish a depth."""
        self._depth.publish(make_image(meters, stamp_ns, **fields))

    def publish(self, shot: pile.Shot, stamp_ns: int) -> None:
        """Publish a picture with its depth and camera_info."""
        self.publish_info((shot.rgb.shape[1], shot.rgb.shape[0]))
        self.publish_depth(shot.z_depth, stamp_ns)
        self.publish_image(shot.rgb, stamp_ns)


def play(camera: Camera, shots: list[pile.Shot], count: int, hz: float) -> list[int]:
    """Publish pictures at a rate, back and forth along the way; returns their stamps."""
    stamps = []
    way = shots + shots[-2:0:-1]
    begun = time.monotonic()
    for number in range(count):
        time.sleep(max(0.0, begun + number / hz - time.monotonic()))
        stamps.append(time.time_ns())
        camera.publish(way[number % len(way)], stamps[-1])
    return stamps
