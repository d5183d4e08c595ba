from __future__ import annotations

import math
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fathom.ros.transforms import NoPose, Transforms

LEVEL = (0.0, 0.0, 0.0, 1.0)


def turn_about_z(degrees: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, math.sin(math.radians(degrees) / 2), math.cos(math.radians(degrees) / 2)


def make_message(parent: str, child: str, at_s: float, moved: tuple[float, ...], turned: tuple[float, ...]) -> Any:
    stamp = SimpleNamespace(sec=int(at_s), nanosec=round(at_s % 1 * 1e9))
    transform = SimpleNamespace(
        translation=SimpleNamespace(**dict(zip("xyz", moved, strict=True))),
        rotation=SimpleNamespace(**dict(zip("xyzw", turned, strict=True))),
    )
    header = SimpleNamespace(stamp=stamp, frame_id=parent)
    return SimpleNamespace(transforms=[SimpleNamespace(header=header, child_frame_id=child, transform=transform)])


def make_vehicle() -> Transforms:
    transforms = Transforms()
    transforms.add(make_message("map", "base", 1.0, (0.0, 0.0, -2.0), turn_about_z(0)))
    transforms.add(make_message("map", "base", 2.0, (4.0, 0.0, -2.0), turn_about_z(90)))
    transforms.add_static(make_message("base", "/camera", 0.0, (1.0, 0.0, 0.0), LEVEL))
    return transforms


def test_a_pose_is_the_product_of_its_transforms_between_their_stamps() -> None:
    pose = make_vehicle().find_pose("camera", "map", 1_500_000_000)
    half = math.sqrt(0.5)
    assert pose[:3, 3] == pytest.approx([2 + half, half, -2])
    assert pose[:3, :3] == pytest.approx(np.array([[half, -half, 0], [half, half, 0], [0, 0, 1]]))
    assert make_vehicle().find_pose("map", "map", 0).tolist() == np.eye(4).tolist()
    exact = make_vehicle().find_pose("base", "map", 2_000_000_000)
    assert exact[:3, 3].tolist() == [4, 0, -2]


def test_a_rotation_takes_the_short_way() -> None:
    transforms = Transforms()
    transforms.add(make_message("map", "base", 0.0, (0.0, 0.0, 0.0), turn_about_z(-10)))
    transforms.add(make_message("map", "base", 1.0, (0.0, 0.0, 0.0), tuple(-x for x in turn_about_z(10))))
    assert transforms.find_pose("base", "map", 500_000_000)[:3, :3] == pytest.approx(np.eye(3))


@pytest.mark.parametrize(
    ("frame", "stamp_ns", "message"),
    [
        ("lidar", 1_500_000_000, "/tf has no transform from `lidar` towards `map`"),
        ("camera", 3_000_000_000, "/tf has `base` from 1.000 to 2.000 s, but the picture was taken at 3.000 s"),
        ("camera", 500_000_000, "/tf has `base` from 1.000 to 2.000 s"),
    ],
)
def test_a_missing_transform_is_an_error(frame: str, stamp_ns: int, message: str) -> None:
    with pytest.raises(NoPose, match=message):
        make_vehicle().find_pose(frame, "map", stamp_ns)


def test_a_loop_is_an_error() -> None:
    transforms = Transforms()
    transforms.add_static(make_message("a", "b", 0.0, (0.0, 0.0, 0.0), LEVEL))
    transforms.add_static(make_message("b", "a", 0.0, (0.0, 0.0, 0.0), LEVEL))
    with pytest.raises(NoPose, match="more than 64 transforms"):
        transforms.find_pose("a", "map", 0)


def test_a_picture_waits_for_the_transforms_of_its_stamp() -> None:
    transforms = make_vehicle()
    late = make_message("map", "base", 3.0, (6.0, 0.0, 0.0), LEVEL)
    threading.Timer(0.05, transforms.add, [late]).start()
    assert transforms.find_pose("base", "map", 3_000_000_000, wait_s=10)[0, 3] == 6


def test_old_transforms_are_dropped() -> None:
    transforms = make_vehicle()
    transforms.add(make_message("map", "base", 100.0, (0.0, 0.0, 0.0), LEVEL))
    with pytest.raises(NoPose, match=r"from 100\.000 to 100\.000 s"):
        transforms.find_pose("base", "map", 1_500_000_000)


def test_a_clock_that_was_reset_begins_again() -> None:
    transforms = Transforms()
    transforms.add(make_message("map", "base", 100.0, (1.0, 0.0, 0.0), LEVEL))
    transforms.add(make_message("map", "base", 1.0, (2.0, 0.0, 0.0), LEVEL))
    assert transforms.find_pose("base", "map", 1_000_000_000)[0, 3] == 2
