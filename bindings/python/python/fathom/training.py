"""Training of style waters."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.errors import CommandError, InvalidArgument

Photo: TypeAlias = "str | os.PathLike[str] | NDArray[Any]"
"""The path of a PNG, JPEG or WebP file, or sRGB codes, uint8 or uint16, of shape (H, W, 3)."""


@dataclass(frozen=True)
class Style:
    """A trained style water."""

    name: str
    onnx: bytes
    """The network."""
    card: dict[str, Any]
    """Origin, terms, losses."""
    sheet: NDArray[np.uint8]
    """The photos, and four scenes before and after: (H, W, 3)."""

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Write NAME.onnx and NAME.card.json; pass the folder as `Job(…, styles=folder)`."""
        place = Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        (place / f"{self.name}.onnx").write_bytes(self.onnx)
        (place / f"{self.name}.card.json").write_text(json.dumps(self.card, indent=2), encoding="utf-8")
        return place


def train(
    photos: Photo | Sequence[Photo],
    name: str,
    *,
    steps: int = 1000,
    seed: int = 1,
    threads: int | None = None,
    range: bool = False,
    license: str | None = None,
    licence: str | None = None,
    progress: bool = True,
) -> Style:
    """Train a style water from one or more photos of the same water.

    The same photos, seed and steps give the same network, whatever `threads` is. With `range` it takes the range of
    each pixel as well, and its scenes must have one. `license`, with the alias `licence`, is the license of the photos
    and default "unknown"; the card stores it as `licence`. Raises `CommandError` with the reason if a photo is
    unsuitable.
    """
    stored = choose_license(license, licence) or "unknown"
    given = [photos] if isinstance(photos, (str, os.PathLike, np.ndarray)) else list(photos)
    with tempfile.TemporaryDirectory(prefix="fathom-train-") as folder:
        place = Path(folder)
        options = ["--name", name, "--seed", str(seed), "--steps", str(steps), "--licence", stored]
        if range:
            options.append("--range")
        if threads is not None:
            options += ["--threads", str(threads)]
        files = [_file(photo, place / f"photo-{number}.png") for number, photo in enumerate(given)]
        command = [sys.executable, "-m", "fathom", "train", *files, *options, "--no-add", "--out", str(place / "out")]
        ended = subprocess.run(
            command, stdout=subprocess.DEVNULL, stderr=None if progress else subprocess.PIPE, text=True
        )
        if ended.returncode != 0:
            reason = (ended.stderr or "").strip().removeprefix("fathom: ")
            raise CommandError(reason or f"the training ended with {ended.returncode}", ended.returncode)
        read = {end: (place / "out" / f"{name}.{end}").read_bytes() for end in ("onnx", "card.json", "sheet.png")}
    return Style(name, read["onnx"], json.loads(read["card.json"]), _native.decode(read["sheet.png"]))


def choose_license(license: str | None, licence: str | None) -> str | None:
    """Return the license in either spelling. Raises `InvalidArgument` for two different ones."""
    if license is not None and licence is not None and license != licence:
        raise InvalidArgument(f"`license` is {license!r} but `licence` is {licence!r}; give one of them")
    return licence if license is None else license


def _file(photo: Photo, place: Path) -> str:
    if isinstance(photo, np.ndarray):
        place.write_bytes(_native.encode_png(photo))
        return str(place)
    return os.fspath(photo)
