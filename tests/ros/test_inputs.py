"""Depths that are late, missing or wrong, and cameras that contradict the pictures: the node continues after each."""

import time
from typing import Any

import numpy as np
import pytest
from camera_driver import Camera, play
from harness import Diagnostics, Node, Subscriber, wait_until

WARN, ERROR = 1, 2
Shots = list[Any]


def expect_recovery(camera: Camera, subscriber: Subscriber, shots: Shots) -> None:
    """Check that the next good pictures arrive."""
    stamps = play(camera, shots, 3, 10)
    wait_until(
        lambda: stamps[-1] in [arrival.stamp_ns for arrival in subscriber.list_arrivals()], "a good picture arrives"
    )


def test_a_late_depth_still_pairs(camera: Camera, subscriber: Subscriber, shots: Shots) -> None:
    stamp = time.time_ns()
    camera.publish_image(shots[0].rgb, stamp)
    time.sleep(0.4)
    assert stamp not in [arrival.stamp_ns for arrival in subscriber.list_arrivals()]
    camera.publish_depth(shots[0].z_depth, stamp)
    wait_until(lambda: stamp in [arrival.stamp_ns for arrival in subscriber.list_arrivals()], "the picture arrives")


def test_the_nearest_depth_within_the_slop_pairs(camera: Camera, subscriber: Subscriber, shots: Shots) -> None:
    stamp = time.time_ns()
    camera.publish_image(shots[0].rgb, stamp)
    camera.publish_depth(shots[0].z_depth, stamp + 15_000_000)
    wait_until(lambda: stamp in [arrival.stamp_ns for arrival in subscriber.list_arrivals()], "the picture arrives")


def test_a_depth_that_comes_after_its_picture_was_dropped_is_counted_as_late(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots
) -> None:
    late, without = (diagnostics.read_total(name) for name in ("late depths", "without depth"))
    time.sleep(0.1)
    stamp = time.time_ns()
    camera.publish_image(shots[0].rgb, stamp)
    # The next depth decides about the picture: later ones cannot be nearer.
    time.sleep(0.1)
    expect_recovery(camera, subscriber, shots)
    camera.publish_depth(shots[0].z_depth, stamp)
    level, message, _ = diagnostics.wait_for("depths on /camera/depth came after their pictures were dropped")
    assert level == WARN
    assert "raise `depth_wait_s`" in message
    expect_recovery(camera, subscriber, shots)
    assert diagnostics.read_total("late depths") == late + 1
    assert diagnostics.read_total("without depth") == without + 1
    assert stamp not in [arrival.stamp_ns for arrival in subscriber.list_arrivals()]


def test_pictures_without_depth_are_dropped_and_counted(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots
) -> None:
    dropped, before = [], diagnostics.read_total("without depth")
    # The last depth is more than `slop_s` away.
    time.sleep(0.1)
    for _ in range(15):
        dropped.append(time.time_ns())
        camera.publish_image(shots[0].rgb, dropped[-1])
        time.sleep(0.1)
    level, message, _ = diagnostics.wait_for("no depth on /camera/depth within `slop_s`")
    assert level == WARN
    assert "set `use_depth` to false" in message
    expect_recovery(camera, subscriber, shots)
    assert not set(dropped) & {arrival.stamp_ns for arrival in subscriber.list_arrivals()}
    assert diagnostics.read_total("without depth") == before + 15


def test_a_depth_of_another_size_is_refused(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots
) -> None:
    stamp = time.time_ns()
    camera.publish_depth(np.ascontiguousarray(shots[0].z_depth[:-1]), stamp)
    camera.publish_image(shots[0].rgb, stamp)
    level, _, _ = diagnostics.wait_for("`z_depth` is 160×119 but `rgb` is 160×120")
    assert level == ERROR
    expect_recovery(camera, subscriber, shots)


@pytest.mark.parametrize(
    ("fields", "expected"),
    [
        ({"encoding": "yuv422"}, '/camera/image: `encoding` is "yuv422"; must be rgb8, bgr8, rgba8, bgra8, mono8'),
        ({"step": 470}, "/camera/image: `step` is 470; must be 480 or more"),
        ({"height": 121}, "/camera/image: `data` has 57600 bytes; must have 58080"),
    ],
)
def test_a_wrong_picture_is_refused(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots, fields: dict, expected: str
) -> None:
    stamp = time.time_ns()
    camera.publish_depth(shots[0].z_depth, stamp)
    camera.publish_image(shots[0].rgb, stamp, **fields)
    assert diagnostics.wait_for(expected)[0] == ERROR
    expect_recovery(camera, subscriber, shots)


def test_an_unknown_encoding_of_depths_is_refused(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots
) -> None:
    stamp = time.time_ns()
    camera.publish_depth(shots[0].z_depth, stamp, encoding="64FC1")
    camera.publish_image(shots[0].rgb, stamp)
    assert diagnostics.wait_for('/camera/depth: `encoding` is "64FC1"; must be 32FC1')[0] == ERROR
    expect_recovery(camera, subscriber, shots)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 0.0, -1.0])
def test_depths_without_a_return_render_as_water(
    camera: Camera, subscriber: Subscriber, diagnostics: Diagnostics, shots: Shots, value: float
) -> None:
    stamp = time.time_ns()
    camera.publish_depth(np.full_like(shots[0].z_depth, value), stamp)
    camera.publish_image(shots[0].rgb, stamp)
    wait_until(lambda: stamp in [arrival.stamp_ns for arrival in subscriber.list_arrivals()], "the picture arrives")
    diagnostics.forget()
    _, _, values = diagnostics.wait_for("")
    assert "/camera/depth: no pixel has a distance above 0" in values["warnings"]
    expect_recovery(camera, subscriber, shots)


def test_big_endian_millimeters_equal_their_native_order(camera: Camera, subscriber: Subscriber, shots: Shots) -> None:
    meters = np.nan_to_num(shots[0].z_depth, posinf=0)
    codes = np.round(1000 * meters).astype(np.uint16)
    stamp = time.time_ns()
    sent = {stamp: (codes, 0), stamp + 1: (codes.byteswap(), 1)}
    for number, (pixels, order) in sent.items():
        camera.publish_depth(pixels, number, is_bigendian=order)
        camera.publish_image(shots[0].rgb, number)
        wait_until(lambda at=number: at in [a.stamp_ns for a in subscriber.list_arrivals()], "the picture arrives")
    checksums = {a.stamp_ns: a.checksum for a in subscriber.list_arrivals()}
    assert checksums[stamp] == checksums[stamp + 1]


@pytest.mark.parametrize(
    ("size", "fields", "expected"),
    [
        ((320, 240), {}, "/camera/camera_info: describes pictures of 320×240, but they are 160×120"),
        ((160, 120), {"k": [0.0] * 9}, "`k` has the focal lengths 0 and 0 px; must be above 0"),
        (
            (160, 120),
            {"k": [100.0, 0, 300, 0, 100, 60, 0, 0, 1]},
            "`camera` has cx 300, outside of the picture of 160×120",
        ),
    ],
)
def test_a_camera_that_contradicts_the_picture_is_refused(
    camera: Camera,
    subscriber: Subscriber,
    diagnostics: Diagnostics,
    shots: Shots,
    size: tuple[int, int],
    fields: dict,
    expected: str,
) -> None:
    camera.publish_info(size, **fields)
    time.sleep(0.2)
    stamp = time.time_ns()
    camera.publish_depth(shots[0].z_depth, stamp)
    camera.publish_image(shots[0].rgb, stamp)
    assert diagnostics.wait_for(expected)[0] == ERROR
    expect_recovery(camera, subscriber, shots)


def test_the_node_is_alive_after_all_faults(node: Node) -> None:
    assert node.process.poll() is None
