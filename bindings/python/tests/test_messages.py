from __future__ import annotations

import array
import random
import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fathom import _native
from fathom.messages.cameras import has_distortion, read_camera
from fathom.messages.errors import MessageError
from fathom.messages.images import is_compressed, read_depth, read_picture, read_stamp, write_fields
from fathom.messages.pairing import Pairing
from numpy.typing import NDArray

SECOND = 1_000_000_000


def make_image(encoding: str, pixels: NDArray[Any], padding: int = 0, **changes: Any) -> SimpleNamespace:
    """Make a message as `rclpy` has it: rows of bytes with padding."""
    height, width = pixels.shape[:2]
    rows = np.ascontiguousarray(pixels).reshape(height, -1).view(np.uint8)
    rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=7)
    fields = {"height": height, "width": width, "encoding": encoding, "is_bigendian": 0, "step": rows.shape[1]}
    return SimpleNamespace(**fields | {"data": array.array("B", rows.tobytes())} | changes)


@pytest.mark.parametrize(
    ("encoding", "channels", "samples"),
    [("rgb8", "rgb", 3), ("bgr8", "bgr", 3), ("rgba8", "rgba", 4), ("bgra8", "bgra", 4), ("mono8", "mono", 1)],
)
@pytest.mark.parametrize("padding", [0, 5])
def test_a_picture_is_a_view_without_its_padding(encoding: str, channels: str, samples: int, padding: int) -> None:
    pixels = np.arange(4 * 5 * samples, dtype=np.uint8).reshape(4, 5, samples)
    message = make_image(encoding, pixels, padding)
    picture = read_picture(message, "/image")
    assert picture.channels == channels
    assert np.array_equal(picture.rgb, pixels[:, :, 0] if samples == 1 else pixels)
    message.data[0] = 99
    assert picture.rgb.flat[0] == 99


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("encoding", "kind"), [("32FC1", "f4"), ("16UC1", "u2")])
@pytest.mark.parametrize("padding", [0, 3, 4])
def test_depths_of_any_byte_order_and_step_are_equal(order: str, encoding: str, kind: str, padding: int) -> None:
    expected = np.arange(1, 13, dtype=kind).reshape(3, 4) * 100
    message = make_image(encoding, expected.astype(order + kind), padding, is_bigendian=int(order == ">"))
    depth = read_depth(message, "/depth")
    assert depth.dtype == np.dtype(kind)
    assert depth.flags.aligned
    assert np.array_equal(depth, expected)


def test_a_file_of_a_picture_becomes_a_picture() -> None:
    pixels = np.random.default_rng(1).integers(0, 255, (6, 8, 3), np.uint8)
    message = SimpleNamespace(format="rgb8; png compressed", data=array.array("B", _native.encode_png(pixels)))
    assert is_compressed(message)
    assert np.array_equal(read_picture(message, "/image/compressed").rgb, pixels)


@pytest.mark.parametrize("kind", ["16UC1", "32FC1"])
def test_depths_of_the_compressed_transport_are_decoded(kind: str) -> None:
    codes = np.array([[0, 500], [1000, 4000]], np.uint16)
    head = struct.pack("<iff", 0, 2000.0, 1.0)
    data = head + _native.encode_png(codes)
    depth = read_depth(SimpleNamespace(format=f"{kind}; compressedDepth png", data=data), "/depth")
    if kind == "16UC1":
        assert np.array_equal(depth, codes)
    else:
        expected = [[np.nan, 2000 / 499], [2000 / 999, 2000 / 3999]]
        np.testing.assert_allclose(depth, expected, rtol=1e-6)


PIXELS = np.zeros((4, 5, 3), np.uint8)
DEPTH = np.zeros((4, 5), np.float32)


@pytest.mark.parametrize(
    ("message", "error"),
    [
        (make_image("yuv422", PIXELS), '/image: `encoding` is "yuv422"; must be rgb8, bgr8, rgba8, bgra8, mono8'),
        (make_image("rgb8", PIXELS, step=14), "/image: `step` is 14; must be 15 or more for 5 pixels of rgb8"),
        (make_image("rgb8", PIXELS, step=16), "/image: `data` has 60 bytes; must have 64 (`height` 4 × `step` 16)"),
        (make_image("rgb8", PIXELS, width=0), "/image: `width` is 0; must be 1 or more"),
        (SimpleNamespace(format="jpeg", data=b"no"), '/image: `data` of format "jpeg": the file is neither PNG'),
        (SimpleNamespace(format="32FC1; compressedDepth png", data=b""), "a depth; must be jpeg or png"),
        (
            SimpleNamespace(format="png", data=_native.encode_png(PIXELS.astype(np.uint16))),
            "/image: `data` has 16 bits per sample; must have 8",
        ),
    ],
)
def test_a_wrong_picture_names_topic_field_value_and_limit(message: Any, error: str) -> None:
    with pytest.raises(MessageError) as raised:
        read_picture(message, "/image")
    assert error in str(raised.value)


@pytest.mark.parametrize(
    ("message", "error"),
    [
        (make_image("rgb8", PIXELS), '`encoding` is "rgb8"; must be 32FC1 (meters) or 16UC1 (millimeters)'),
        (SimpleNamespace(format="16UC1; compressedDepth png", data=b"abc"), "has 3 bytes; must have more than 12"),
        (SimpleNamespace(format="png", data=_native.encode_png(PIXELS)), "8 bits in 3 channels; must have 16 bits"),
    ],
)
def test_a_wrong_depth_names_topic_field_value_and_limit(message: Any, error: str) -> None:
    with pytest.raises(MessageError) as raised:
        read_depth(message, "/depth")
    assert str(raised.value).startswith("/depth: ")
    assert error in str(raised.value)


@pytest.mark.parametrize(
    ("values", "encoding", "step"),
    [
        (np.arange(60, dtype=np.uint8).reshape(4, 5, 3), "rgb8", 15),
        (np.arange(60, dtype=np.uint16).reshape(4, 5, 3), "rgb16", 30),
        (np.arange(20, dtype=np.uint8).reshape(4, 5), "mono8", 5),
        (np.arange(20, dtype=np.float32).reshape(4, 5), "32FC1", 20),
    ],
)
def test_written_fields_hold_the_array(values: NDArray[Any], encoding: str, step: int) -> None:
    fields = write_fields(values[:, ::-1])
    assert (fields["height"], fields["width"], fields["encoding"], fields["step"]) == (4, 5, encoding, step)
    assert fields["data"].tobytes() == values[:, ::-1].tobytes()


def test_the_camera_info_of_ros1_has_capital_letters() -> None:
    region = SimpleNamespace(x_offset=0, y_offset=0, width=0, height=0)
    sizes = {"width": 5, "height": 4, "binning_x": 0, "binning_y": 0, "roi": region}
    info = SimpleNamespace(
        **sizes, K=[4.0, 0, 2, 0, 4, 1.5, 0, 0, 1], P=[5.0, 0, 2, 0, 0, 5, 1, 0, 0, 0, 1, 0], D=[0.1]
    )
    assert read_camera(info, (5, 4), "/info", rectified=False).tolist() == [[4, 0, 2], [0, 4, 1.5], [0, 0, 1]]
    assert read_camera(info, (5, 4), "/info", rectified=True).tolist() == [[5, 0, 2], [0, 5, 1], [0, 0, 1]]
    assert has_distortion(info)


def test_a_stamp_before_1970_is_refused() -> None:
    header = SimpleNamespace(stamp=SimpleNamespace(sec=2, nanosec=5))
    assert read_stamp(SimpleNamespace(header=header), "/image") == 2 * SECOND + 5
    header.stamp.sec = -1
    with pytest.raises(MessageError, match="must be 0 or more"):
        read_stamp(SimpleNamespace(header=header), "/image")


def pair_all(images: list[int], depths: list[int], chance: float, seed: int = 0) -> tuple[list[Any], int]:
    """Feed two ascending topics in a random interleaving."""
    draw, pairing, pairs = random.Random(seed), Pairing[int, int](), list[Any]()
    waiting_images, waiting_depths = list(images), list(depths)
    while waiting_images or waiting_depths:
        if waiting_images and (not waiting_depths or draw.random() < chance):
            stamp = waiting_images.pop(0)
            pairs += pairing.add_image(stamp, stamp)
        else:
            stamp = waiting_depths.pop(0)
            pairs += pairing.add_depth(stamp, stamp)
    pairs += pairing.flush()
    return [(pair.image, pair.depth) for pair in pairs], pairing.unused_depths


@pytest.mark.parametrize("seed", range(20))
def test_pairs_do_not_depend_on_the_order_of_arrival(seed: int) -> None:
    draw = random.Random(seed)
    images = sorted(draw.sample(range(0, 800_000_000, 1_000_000), 20))
    depths = sorted({*draw.sample(range(0, 800_000_000, 1_000_000), 15), *images[::3]})
    nearest = [min(depths, key=lambda depth: (abs(depth - image), depth)) for image in images]
    pairs = zip(images, nearest, strict=True)
    expected = [(image, depth if abs(depth - image) <= 20_000_000 else None) for image, depth in pairs]
    used = {depth for _, depth in expected if depth is not None}
    for chance in (0.0, 0.3, 0.7, 1.0):
        assert pair_all(images, depths, chance, seed) == (expected, len(depths) - len(used))


def test_an_image_does_not_wait_forever() -> None:
    pairing = Pairing[str, str](wait_ns=SECOND)
    assert pairing.add_image(0, "first") == []
    assert pairing.add_image(SECOND, "second") == []
    assert [pair.image for pair in pairing.add_image(SECOND + 1, "third")] == ["first"]
    assert pairing.waiting == 2
    # Stamps that stand still do not fill the memory.
    stuck = Pairing[int, int]()
    assert sum(len(stuck.add_image(0, number)) for number in range(1000)) > 800


def test_the_offset_of_a_late_depth_is_known() -> None:
    pairing = Pairing[str, str]()
    pairing.add_image(SECOND, "image")
    (pair,) = pairing.add_depth(SECOND + 50_000_000, "late")
    assert (pair.depth, pair.offset_ns) == (None, 50_000_000)


def test_depths_that_come_after_their_images_were_returned_are_counted() -> None:
    pairing = Pairing[str, str](wait_ns=SECOND)
    pairing.add_image(0, "without a depth for a second")
    pairing.add_image(2 * SECOND, "passed by a later depth")
    pairing.add_depth(3 * SECOND, "of neither image")
    pairing.add_depth(2 * SECOND + 20_000_001, "beyond the slop")
    assert pairing.late_depths == 0
    pairing.add_depth(2 * SECOND + 20_000_000, "at the limit of the slop")
    assert pairing.late_depths == 1
    # Each image has one late depth.
    pairing.add_depth(2 * SECOND + 1, "also near")
    assert pairing.late_depths == 1
    # An image that has a depth misses none.
    pairing.add_image(4 * SECOND, "good")
    (pair,) = pairing.add_depth(4 * SECOND, "good")
    pairing.add_depth(4 * SECOND + 1, "second")
    assert (pair.depth, pairing.late_depths) == ("good", 1)


def test_a_clock_that_jumps_back_restarts_the_pairing() -> None:
    pairing = Pairing[str, str]()
    pairing.add_image(50 * SECOND, "old")
    pairing.add_depth(50 * SECOND + 1, "old")
    pairing.add_depth(0, "new")
    (pair,) = pairing.add_image(0, "new")
    assert pair.depth == "new"
    # The clock of the images may jump before that of the depths.
    pairing.add_image(60 * SECOND, "old")
    pairing.add_depth(60 * SECOND, "old")
    pairing.add_image(SECOND, "first")
    pairing.add_depth(61 * SECOND, "old")
    pairing.add_depth(2 * SECOND, "new")
    (pair,) = pairing.add_image(2 * SECOND, "second")
    assert pair.depth == "new"
