"""Writes a picture as WebP of at most 150 kB, the limit of pictures in docs.

    pip install pillow
    python scripts/write_webp.py target/docs/pictures/camera-sheet.png docs/pictures/camera.webp
"""

import io
import pathlib
import sys

from PIL import Image

LIMIT_BYTES = 150_000
MAX_WIDTH = 1280


def encode(picture: Image.Image, quality: int) -> bytes:
    """Return the picture as WebP."""
    buffer = io.BytesIO()
    picture.save(buffer, "WEBP", quality=quality, method=6)
    return buffer.getvalue()


def main() -> None:
    """Lower the quality until the file is small enough."""
    source, target = map(pathlib.Path, sys.argv[1:3])
    picture = Image.open(source).convert("RGB")
    picture.thumbnail((MAX_WIDTH, picture.height))
    for quality in range(86, 30, -4):
        encoded = encode(picture, quality)
        if len(encoded) <= LIMIT_BYTES:
            target.write_bytes(encoded)
            print(f"{target}: {len(encoded)} bytes, quality {quality}")
            return
    sys.exit(f"{source} does not fit into {LIMIT_BYTES} bytes as WebP; crop it or make it smaller")


if __name__ == "__main__":
    main()
