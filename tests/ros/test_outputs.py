"""All results of the node."""

import json
from typing import Any

import numpy as np
from camera_driver import Camera, play
from conftest import Start
from harness import Node, ParameterClient, wait_until
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, CompressedImage, Image


def test_all_results_are_published_with_the_header_of_the_picture(
    camera: Camera, start: Start, shots: list[Any]
) -> None:
    start(Node, mode="water+enhance", water__optics="jerlov-3C")
    camera.wait_for_node()
    received: dict[str, Any] = {}
    topics = {
        "image": Image,
        "image/compressed": CompressedImage,
        "camera_info": CameraInfo,
        "range": Image,
        "enhanced/hscm": Image,
    }
    for name, kind in topics.items():
        camera.node.create_subscription(
            kind,
            f"/fathom/{name}",
            lambda message, name=name: received.setdefault(name, message),
            qos_profile_sensor_data,
        )
    wait_until(lambda: all(camera.node.count_publishers(f"/fathom/{name}") for name in topics), "the topics are there")
    stamps: list[int] = []

    def send() -> bool:
        stamps.extend(play(camera, shots, 1, 10))
        return received.keys() == topics.keys()

    wait_until(send, "all topics have a message")
    for name, message in received.items():
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        assert stamp in stamps, name
        assert message.header.frame_id == "camera_optical", name
    assert bytes(received["image/compressed"].data[:2]) == b"\xff\xd8"
    assert received["camera_info"].width == 160
    assert (received["range"].encoding, received["range"].step) == ("32FC1", 640)
    meters = np.frombuffer(received["range"].data, np.float32)
    # The sky has no return; the pile is about 2 m away.
    assert np.isnan(meters).any()
    assert 1 < np.nanmin(meters) < 2.5
    assert received["image"].data != received["enhanced/hscm"].data


def test_enhancements_with_parameters_and_chains_have_topics_and_change_while_running(
    camera: Camera, start: Start, shots: list[Any]
) -> None:
    wide = {"method": "hscm", "name": "wide", "cutoff": 64}
    chain = {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3, "tiles": [4, 4]}}]}
    start(Node, mode="enhance", enhance=json.dumps([wide, chain, "hscm"]))
    received: dict[str, bytes] = {}
    names = ["wide", "mine", "hscm"]
    for name in names:
        camera.node.create_subscription(
            Image,
            f"/fathom/enhanced/{name}",
            lambda message, name=name: received.update({name: bytes(message.data)}),
            qos_profile_sensor_data,
        )
    wait_until(lambda: all(camera.node.count_publishers(f"/fathom/enhanced/{name}") for name in names), "the topics")
    wait_until(lambda: play(camera, shots[:1] * 2, 1, 10) and len(received) == 3, "each enhancement has a picture")
    assert len(set(received.values())) == 3
    # A parameter of one enhancement changes its picture, to that of the default, and no other.
    before = dict(received)
    [(is_accepted, reason)] = ParameterClient(camera.node).set(enhance__0__cutoff=32.0)
    assert is_accepted, reason
    received.clear()
    wait_until(
        lambda: play(camera, shots[:1] * 2, 1, 10) and received.get("wide") == before["hscm"], "the changed picture"
    )
    assert (received["mine"], received["hscm"]) == (before["mine"], before["hscm"])
