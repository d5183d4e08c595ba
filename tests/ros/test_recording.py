"""A recording that is played to the node has the results of `fathom bag` over the same recording."""

import hashlib
import json
import pathlib
import subprocess
import sys
from typing import Any

import numpy as np
from camera_driver import Camera, make_camera_info, play
from conftest import Start
from fathom.bag.recording import Recording
from harness import Node, wait_until
from rclpy.qos import QoSProfile
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import CameraInfo, Image


START_NS, STEP_NS = 1_700_000_000_000_000_000, 200_000_000
IMAGE, DEPTH, INFO = "/camera/image", "/camera/depth", "/camera/camera_info"
JOB = {
    "seed": 4,
    "water": {"optics": "jerlov-3C", "range_scale": 0.3, "snow": {"density_per_m3": 4000}},
    "lights": [{"kind": "haze", "x": 0.3, "y": 1, "intensity": 0.4}],
    # Noise differs if a frame has the random numbers of another stamp.
    "camera": {"sensor": {}},
    "enhance": ["hscm"],
}
RESULTS = {
    "/fathom/image": f"{IMAGE}/underwater",
    "/fathom/enhanced/hscm": f"{IMAGE}/enhanced/hscm/underwater",
    "/fathom/range": f"{DEPTH}/underwater",
}
"""Topics of the node, and those that `fathom bag` adds."""
Pictures = dict[tuple[str, int], bytes]
"""Pixels by topic of the recording and stamp."""


class Recorder:
    """Writes messages in the format of ROS 2."""

    def __init__(self, writer: Writer) -> None:
        self._writer, self._connections = writer, dict[str, Any]()
        self._store = get_typestore(Stores.ROS2_JAZZY)

    def write(self, topic: str, stamp_ns: int, kind: str, **fields: Any) -> None:
        """Write a message with a header."""
        types = self._store.types
        stamp = types["builtin_interfaces/msg/Time"](sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="camera_optical")
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(topic, kind, typestore=self._store)
        message = types[kind](header=header, **fields)
        self._writer.write(self._connections[topic], stamp_ns, self._store.serialize_cdr(message, kind))

    def write_image(self, topic: str, stamp_ns: int, encoding: str, pixels: np.ndarray) -> None:
        """Write an image."""
        height, width = pixels.shape[:2]
        data = np.ascontiguousarray(pixels).reshape(-1).view(np.uint8)
        fields = {"height": height, "width": width, "step": data.size // height, "data": data, "is_bigendian": 0}
        self.write(topic, stamp_ns, "sensor_msgs/msg/Image", encoding=encoding, **fields)

    def write_info(self, stamp_ns: int, size: tuple[int, int]) -> None:
        """Write the camera of pictures of a size."""
        info, roi = make_camera_info(size, stamp_ns), self._store.types["sensor_msgs/msg/RegionOfInterest"]
        fields = {name: np.array(getattr(info, name), float) for name in ("d", "k", "r", "p")}
        fields |= {name: getattr(info, name) for name in ("height", "width", "distortion_model")}
        whole = roi(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
        self.write(INFO, stamp_ns, "sensor_msgs/msg/CameraInfo", binning_x=0, binning_y=0, roi=whole, **fields)


def record_drive(folder: pathlib.Path, shots: list[Any]) -> pathlib.Path:
    """Record the drive; the depth of every other picture has a later stamp."""
    with Writer(folder / "dive", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        recorder = Recorder(writer)
        for number, shot in enumerate(shots):
            stamp_ns = START_NS + number * STEP_NS
            recorder.write_info(stamp_ns, (shot.rgb.shape[1], shot.rgb.shape[0]))
            recorder.write_image(IMAGE, stamp_ns, "rgb8", shot.rgb)
            recorder.write_image(DEPTH, stamp_ns + number % 2 * 5_000_000, "32FC1", shot.z_depth)
    return folder / "dive"


def convert(dive: pathlib.Path, job: pathlib.Path) -> Pictures:
    """Convert the recording and return the added pictures."""
    wet = dive.with_name("wet.mcap")
    topics = ["--image", IMAGE, "--depth", DEPTH, "--camera-info", INFO, "--range"]
    command = [sys.executable, "-m", "fathom.bag", str(dive), str(wet), "--job", str(job), *topics]
    run = subprocess.run(command, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    pictures: Pictures = {}
    with Recording(wet) as recording:
        added = [each for each in recording.connections if each.topic in RESULTS.values()]
        for connection, _, data in recording.messages(added):
            message = recording.deserialize(connection, data)
            stamp = message.header.stamp
            pictures[connection.topic, stamp.sec * 10**9 + stamp.nanosec] = message.data.tobytes()
    return pictures


class Listener:
    """The pictures that the node publishes."""

    def __init__(self, camera: Camera) -> None:
        self.pictures: Pictures = {}
        for topic, recorded in RESULTS.items():
            camera.node.create_subscription(
                Image, topic, lambda message, name=recorded: self._take(name, message), QoSProfile(depth=10)
            )

    def _take(self, topic: str, message: Image) -> None:
        stamp = message.header.stamp
        self.pictures[topic, stamp.sec * 10**9 + stamp.nanosec] = bytes(message.data)

    def has_topics(self) -> bool:
        """Whether all topics have a result."""
        return {topic for topic, _ in self.pictures} == set(RESULTS.values())

    def has_all(self, stamp_ns: int) -> bool:
        """Whether all results of a picture are there."""
        return all((topic, stamp_ns) in self.pictures for topic in RESULTS.values())


def play_recording(camera: Camera, dive: pathlib.Path, listener: Listener) -> Pictures:
    """Publish the bytes of the messages as they were recorded, and return the results."""
    listener.pictures.clear()
    kinds = {IMAGE: Image, DEPTH: Image, INFO: CameraInfo}
    quality = QoSProfile(depth=10)
    publishers = {topic: camera.node.create_publisher(kind, topic, quality) for topic, kind in kinds.items()}
    wait_until(lambda: all(each.get_subscription_count() for each in publishers.values()), "the node subscribes")
    stamp_ns = START_NS
    with Recording(dive) as recording:
        for connection, _, data in recording.messages():
            publishers[connection.topic].publish(bytes(data))
            if connection.topic == DEPTH:
                # A picture that waits would be replaced by the next one.
                wait_until(lambda at=stamp_ns: listener.has_all(at), f"the results of the picture at {stamp_ns} ns")
                stamp_ns += STEP_NS
    for publisher in publishers.values():
        camera.node.destroy_publisher(publisher)
    # Pictures of the camera before may still have arrived.
    return {key: pixels for key, pixels in listener.pictures.items() if key[1] < stamp_ns}


def compute_digest(pictures: Pictures) -> str:
    """Return the digest of all pictures with their topics and stamps."""
    digest = hashlib.sha256()
    for key in sorted(pictures):
        digest.update(repr(key).encode() + pictures[key])
    return digest.hexdigest()


def test_a_recording_has_one_digest_converted_and_played_twice(
    camera: Camera, start: Start, shots: list[Any], tmp_path: pathlib.Path
) -> None:
    dive, job = record_drive(tmp_path, shots), tmp_path / "job.json"
    job.write_text(json.dumps(JOB))
    converted = convert(dive, job)
    assert len(converted) == len(RESULTS) * len(shots)
    assert len(set(converted.values())) == len(converted)
    start(Node, job=str(job), mode="water+enhance", qos="reliable")
    listener = Listener(camera)
    camera.wait_for_node()
    wait_until(lambda: play(camera, shots, 1, 10) and listener.has_topics(), "the first results arrive")
    played = [play_recording(camera, dive, listener) for _ in range(2)]
    assert [sorted(each) for each in played] == [sorted(converted)] * 2
    assert [compute_digest(each) for each in played] == [compute_digest(converted)] * 2
