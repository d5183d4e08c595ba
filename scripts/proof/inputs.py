"""Input files of the cases, byte for byte the same on every machine. JPEG and WebP are kept in tests/proof/inputs."""

import pathlib
import shutil
import struct
import zlib

WIDTH, HEIGHT = 80, 56
INVALID = 65535


def png(path, width, height, color_type, depth, rows):
    """Writes a PNG whose pixels are stored, not compressed, so that no version of zlib can change its bytes."""
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    raw = b"".join(b"\0" + row for row in rows)
    blocks = [raw[i:i + 65535] for i in range(0, len(raw), 65535)] or [b""]
    stored = b"".join(struct.pack("<BHH", index == len(blocks) - 1, len(block), len(block) ^ 0xFFFF) + block
                      for index, block in enumerate(blocks))
    stream = b"\x78\x01" + stored + struct.pack(">I", zlib.adler32(raw))
    head = struct.pack(">IIBBBBB", width, height, depth, color_type, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", stream) + chunk(b"IEND", b""))


def npy(path, code, shape, values):
    """Writes an NPY file of version 1."""
    kind = {"f": "<f4", "d": "<f8", "B": "|u1", "H": "<u2"}[code]
    head = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {tuple(shape)}, }}".encode()
    head += b" " * (-(len(head) + 11) % 64) + b"\n"
    path.write_bytes(b"\x93NUMPY\1\0" + struct.pack("<H", len(head)) + head + struct.pack(f"<{len(values)}{code}", *values))


def codes(column, row, channel, most=255):
    """A color of the picture: ramps, stripes and blocks, whole numbers only."""
    ramp = (column * (5 + channel) + row * (3 - channel)) % 256
    stripe = 60 if (column // 7 + row // 5) % 2 else 0
    hashed = (column * 73856093 ^ row * 19349663 ^ channel * 83492791) % 23
    return min(most, max(0, ramp // 2 + stripe + hashed) * most // 255)


def millimeters(column, row):
    """Range or depth of a pixel: a slanted floor, a post and holes."""
    if (column * 31 + row * 17) % 97 == 0:
        return INVALID
    if 20 <= column < 30:
        return 1500 + row * 4
    return 2200 + column * 37 + row * 53


def pixels():
    return [(column, row) for row in range(HEIGHT) for column in range(WIDTH)]


def write(folder, kept):
    """Writes all inputs into a folder; `kept` holds those that are stored as files."""
    folder.mkdir(parents=True, exist_ok=True)
    place = lambda name: pathlib.Path(folder, name)
    rows = lambda make: [b"".join(make(column, row) for column in range(WIDTH)) for row in range(HEIGHT)]
    size = (WIDTH, HEIGHT)
    png(place("rgb8.png"), *size, 2, 8, rows(lambda c, r: bytes(codes(c, r, k) for k in range(3))))
    png(place("range16.png"), *size, 0, 16, rows(lambda c, r: struct.pack(">H", millimeters(c, r))))
    meters = [float("nan") if millimeters(c, r) == INVALID else millimeters(c, r) / 1024 for c, r in pixels()]
    npy(place("range.npy"), "f", size[::-1], meters)
    for path in kept.iterdir():
        shutil.copy(path, place(path.name))
