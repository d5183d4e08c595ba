"""Rate, loss and latency from PyBullet through the node to a subscriber with another version of ROS."""

import importlib.metadata
from typing import Any

import numpy as np
import pytest
from camera_driver import Camera, play
from harness import Diagnostics, Node, Subscriber, wait_until

HZ = 10
COUNT = 50


def test_every_picture_of_a_drive_arrives_in_time(
    camera: Camera, node: Node, subscriber: Subscriber, diagnostics: Diagnostics, shots: list[Any]
) -> None:
    assert subscriber.version.split(".")[0] != importlib.metadata.version("ros-rclpy").split(".")[0]
    stamps = play(camera, shots, COUNT, HZ)
    wait_until(lambda: subscriber.list_arrivals()[-1].stamp_ns == stamps[-1], "the last picture arrives")
    arrivals = {arrival.stamp_ns: arrival for arrival in subscriber.list_arrivals()}
    received = [arrivals[stamp] for stamp in stamps if stamp in arrivals]
    latencies = [arrival.latency_ms for arrival in received]
    print(f"{len(received)} of {COUNT}, median {np.median(latencies):.1f} ms, largest {max(latencies):.1f} ms")
    assert len(received) == COUNT
    elapsed_s = (received[-1].received_ns - received[0].received_ns) / 1e9
    assert (COUNT - 1) / elapsed_s == pytest.approx(HZ, rel=0.1)
    assert {(arrival.width, arrival.height, arrival.encoding) for arrival in received} == {(160, 120, "rgb8")}
    # Other processes of the machine may interrupt a frame; a queue that grows would exceed this soon.
    assert np.median(latencies) < 100
    assert max(latencies) < 1000
    # The drive goes back the same way, so that pictures repeat; noise and particles are new for each stamp.
    assert len({arrival.checksum for arrival in received}) > 5
    _, _, values = diagnostics.wait_for("frames per second")
    assert values["total without depth"] == values["total failed"] == "0"
    assert float(values["stage water, ms"]) > 0
    assert "attenuation" in values["plan"]
    assert float(values["error bound"]) > 0
    assert float(values["chain, median ms"]) > 0
