"""Channels of OpenEXR pictures, with the service's rules for colors and distances."""

from __future__ import annotations

import struct
from collections.abc import Sequence

_MAGIC = b"\x76\x2f\x31\x01"
_MULTIPART = 0x1000
_PICTURE_LAYER = "Combined."


def has_distances(file: bytes) -> bool:
    """Return whether a file is an EXR picture with a channel of distances next to its colors."""
    if not file.startswith(_MAGIC):
        return False
    try:
        parts = _read_channels(file)
    except (ValueError, IndexError, struct.error):
        # The service reports damaged files.
        return False
    return _has(parts, ("R", "G", "B")) and (_has(parts, ("Z",)) or _has_depth_layer(parts))


def _read_channels(file: bytes) -> list[list[str]]:
    """Return the names of the channels of each part."""
    is_multipart = struct.unpack_from("<I", file, 4)[0] & _MULTIPART
    parts: list[list[str]] = [[]]
    place = 8
    while True:
        if file[place] == 0:
            place += 1
            if not is_multipart or file[place] == 0:
                return parts
            parts.append([])
        name, place = _read_text(file, place)
        _, place = _read_text(file, place)
        (size,) = struct.unpack_from("<i", file, place)
        if not 0 <= size <= len(file) - place - 4:
            raise ValueError("an attribute ends after the file")
        place += 4
        if name == "channels":
            parts[-1] = _read_names(file[place : place + size])
        place += size


def _read_names(listed: bytes) -> list[str]:
    names: list[str] = []
    place = 0
    while place < len(listed) and listed[place] != 0:
        name, place = _read_text(listed, place)
        names.append(name)
        # Sample type, linearity and sampling.
        place += 16
    return names


def _read_text(file: bytes, place: int) -> tuple[str, int]:
    end = file.index(b"\0", place)
    return file[place:end].decode(), end + 1


def _has(parts: Sequence[Sequence[str]], wanted: Sequence[str]) -> bool:
    """Return whether exactly one layer has these channels, or one that has priority."""
    layers: list[str] = []
    for names in parts:
        for name in names:
            layer = name.removesuffix(wanted[0])
            if not name.endswith(wanted[0]) or not (layer == "" or layer.endswith(".")):
                continue
            is_vector = wanted == ("Z",) and all(f"{layer}{axis}" in names for axis in "XY")
            if not is_vector and all(f"{layer}{channel}" in names for channel in wanted):
                layers.append(layer)
    return len(layers) == 1 or any(layer == "" or layer.endswith(_PICTURE_LAYER) for layer in layers)


def _has_depth_layer(parts: Sequence[Sequence[str]]) -> bool:
    """Return whether one channel besides alpha is called `Depth` or is in a layer of this name."""
    ends = [name.split(".")[-2:] for names in parts for name in names]
    return sum(end[-1] != "A" and "depth" in [part.lower() for part in end] for end in ends) == 1
