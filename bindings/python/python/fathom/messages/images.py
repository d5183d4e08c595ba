"""Arrays from messages with images and depths, and the fields of messages from arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom.messages.compressed import decode_depth, decode_picture
from fathom.messages.errors import MessageError
from fathom.stream import Channels

_PICTURES: dict[str, tuple[Channels, int]] = {
    "rgb8": ("rgb", 3),
    "bgr8": ("bgr", 3),
    "rgba8": ("rgba", 4),
    "bgra8": ("bgra", 4),
    "mono8": ("mono", 1),
}
"""Encodings of pictures: the order of the samples, and their number in a pixel."""

_DEPTHS = {"32FC1": "f4", "16UC1": "u2"}
"""Encodings of depths: float32 meters and uint16 millimeters."""

_ENCODINGS = {("uint8", 3): "rgb8", ("uint16", 3): "rgb16", ("uint8", 1): "mono8", ("float32", 1): "32FC1"}
"""Encodings of written arrays by type and samples of a pixel."""


@dataclass(frozen=True)
class Picture:
    """The arguments `rgb` and `channels` of a `fathom.Stream`."""

    rgb: NDArray[np.uint8]
    channels: Channels


def read_picture(message: Any, topic: str) -> Picture:
    """Return the picture of an `Image` or a `CompressedImage`; raises `MessageError`.

    The array is a view of an `Image`, (H, W, 3), (H, W, 4) or (H, W).
    """
    if is_compressed(message):
        rgb = decode_picture(message, topic)
        return Picture(rgb, "rgb" if rgb.ndim == 3 else "mono")
    if message.encoding not in _PICTURES:
        raise _unknown_encoding(message, topic, ", ".join(_PICTURES))
    channels, samples = _PICTURES[message.encoding]
    view = _view_pixels(message, topic, np.dtype(np.uint8), samples)
    return Picture(view[:, :, 0] if samples == 1 else view, channels)


def read_depth(message: Any, topic: str) -> NDArray[Any]:
    """Return the depth of an `Image` or `CompressedImage`, (H, W); raises `MessageError`.

    float32 meters or uint16 millimeters, as for `z_depth` of a `fathom.Stream`.
    """
    if is_compressed(message):
        return decode_depth(message, topic)
    if message.encoding not in _DEPTHS:
        raise _unknown_encoding(message, topic, "32FC1 (meters) or 16UC1 (millimeters)")
    order = ">" if message.is_bigendian else "<"
    dtype = np.dtype(order + _DEPTHS[message.encoding])
    view = _view_pixels(message, topic, dtype, 1)[:, :, 0]
    # Rows may begin at any byte; copies are only made of rows that do.
    depth: NDArray[Any] = np.require(view, dtype=dtype.newbyteorder("="), requirements="A")
    return depth


def has_distance(depth: NDArray[Any]) -> bool:
    """Whether any pixel has a distance: a finite number above 0."""
    # A few pixels decide about most depths.
    return any(bool((np.isfinite(pixels) & (pixels > 0)).any()) for pixels in (depth[::8, ::8], depth))


def is_compressed(message: Any) -> bool:
    """Whether the message is a `CompressedImage`."""
    return hasattr(message, "format")


def read_stamp(message: Any, topic: str) -> int:
    """Return the stamp of the header in nanoseconds; raises `MessageError` if it is before 1970."""
    stamp = message.header.stamp
    stamp_ns = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
    if stamp_ns < 0:
        raise MessageError(topic, f"`header.stamp` is {stamp_ns} ns; must be 0 or more", "stamp")
    return stamp_ns


def write_fields(array: NDArray[Any]) -> dict[str, Any]:
    """Return the fields of an `Image` apart from its header.

    uint8 or uint16 (H, W, 3) become rgb8 or rgb16, uint8 (H, W) mono8, and float32 (H, W) 32FC1. `data` is a flat
    array of uint8, as `rosbags` wants it; `rclpy` wants `array.array("B", data.tobytes())`.
    """
    height, width = array.shape[:2]
    samples = array.shape[2] if array.ndim == 3 else 1
    encoding = _ENCODINGS[array.dtype.name, samples]
    little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    return {
        "height": height,
        "width": width,
        "encoding": encoding,
        "is_bigendian": 0,
        "step": width * samples * array.dtype.itemsize,
        "data": little.reshape(-1).view(np.uint8),
    }


def _view_pixels(message: Any, topic: str, dtype: np.dtype[Any], samples: int) -> NDArray[Any]:
    """Return a view of the pixels, (H, W, samples), without the padding of the rows."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    for name, value in (("height", height), ("width", width)):
        if value < 1:
            raise MessageError(topic, f"`{name}` is {value}; must be 1 or more", "size")
    pixel = samples * dtype.itemsize
    if step < width * pixel:
        limit = f"must be {width * pixel} or more for {width} pixels of {message.encoding}"
        raise MessageError(topic, f"`step` is {step}; {limit}", "size")
    data = np.frombuffer(message.data, np.uint8)
    if data.size != height * step:
        limit = f"must have {height * step} (`height` {height} × `step` {step})"
        raise MessageError(topic, f"`data` has {data.size} bytes; {limit}", "size")
    view: NDArray[Any] = np.ndarray((height, width, samples), dtype, data.data, strides=(step, pixel, dtype.itemsize))
    return view


def _unknown_encoding(message: Any, topic: str, known: str) -> MessageError:
    return MessageError(topic, f'`encoding` is "{message.encoding}"; must be {known}', "encoding")
