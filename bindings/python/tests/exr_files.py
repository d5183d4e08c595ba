"""Writes small OpenEXR files."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def write_exr(path: Path, channels: Mapping[str, NDArray[np.floating]]) -> Path:
    """Write planes as uncompressed scan lines of floats."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iBxxxii", 2, 0, 1, 1) for name in names) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    attributes = [
        ("channels", "chlist", listed),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1)),
    ]
    head = struct.pack("<ii", 20000630, 2)
    for name, kind, value in attributes:
        head += f"{name}\0{kind}\0".encode() + struct.pack("<i", len(value)) + value
    head += b"\0"
    line_bytes = 4 * width * len(names)
    offsets = [len(head) + 8 * height + row * (8 + line_bytes) for row in range(height)]
    lines = [
        struct.pack("<ii", row, line_bytes)
        + b"".join(np.ascontiguousarray(channels[name][row], np.float32).tobytes() for name in names)
        for row in range(height)
    ]
    path.write_bytes(head + struct.pack(f"<{height}Q", *offsets) + b"".join(lines))
    return path
