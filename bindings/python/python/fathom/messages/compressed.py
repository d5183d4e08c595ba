"""Arrays from compressed messages: files of pictures, and those of `compressed_depth_image_transport`."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.messages.errors import MessageError

_TRANSPORT = "compressedDepth"
_CONFIGURATION = struct.Struct("<iff")
"""What the transport writes before the file: a format, and the parameters A and B of float depths."""


def decode_picture(message: Any, topic: str) -> NDArray[np.uint8]:
    """Return the picture, (H, W, 3) or (H, W); raises `MessageError`."""
    if _TRANSPORT in message.format:
        raise MessageError(topic, f'`format` is "{message.format}", a depth; must be jpeg or png', "encoding")
    picture = _decode(message, topic, bytes(message.data))
    if picture.dtype != np.uint8:
        raise MessageError(topic, f"`data` has {8 * picture.itemsize} bits per sample; must have 8", "encoding")
    return picture


def decode_depth(message: Any, topic: str) -> NDArray[Any]:
    """Return the depth: uint16 millimeters, or float32 meters of `32FC1; compressedDepth`; raises `MessageError`."""
    data = bytes(message.data)
    if _TRANSPORT not in message.format:
        return _require_codes(_decode(message, topic, data), topic)
    if len(data) <= _CONFIGURATION.size:
        raise MessageError(topic, f"`data` has {len(data)} bytes; must have more than {_CONFIGURATION.size}", "size")
    _, numerator, offset = _CONFIGURATION.unpack_from(data)
    codes = _require_codes(_decode(message, topic, data[_CONFIGURATION.size :]), topic)
    if not message.format.startswith("32FC1"):
        return codes
    # The transport stores A / depth + B, and 0 for no return.
    with np.errstate(divide="ignore"):
        meters: NDArray[np.float32] = np.float32(numerator) / (codes.astype(np.float32) - np.float32(offset))
    meters[codes == 0] = np.nan
    return meters


def _decode(message: Any, topic: str, data: bytes) -> NDArray[Any]:
    try:
        return _native.decode(data)
    except ValueError as error:
        raise MessageError(topic, f'`data` of format "{message.format}": {error}', "encoding") from None


def _require_codes(codes: NDArray[Any], topic: str) -> NDArray[np.uint16]:
    if codes.dtype != np.uint16 or codes.ndim != 2:
        held = f"{8 * codes.itemsize} bits in {codes.shape[2] if codes.ndim == 3 else 1} channels"
        raise MessageError(topic, f"`data` has {held}; must have 16 bits in one, millimeters as PNG", "encoding")
    return codes
