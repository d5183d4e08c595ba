"""Sharded datasets, complete or not: a folder of `fathom render --shard`, here or at a URL that fsspec reads."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fathom.errors import FathomError, RenderError
from fathom.frame import Frame
from fathom.places import Place, read_if_present
from fathom.stored import checked, decode_artifact
from fathom.tars import RECORD, TarIndex, index_tar

CARD = "job.json"
FORMAT = 1
"""Version of the layout that this version reads."""
_MARKER = re.compile(r"\d{6,}\.json")
_ATTEMPT = re.compile(r"[0-9A-Za-z_-]{1,64}")


@dataclass(frozen=True)
class Shard:
    """A completed shard with at least one image."""

    tar: str
    images: int


class ShardedDataset:
    """Frames of the shards that were complete when it was opened.

    The headers of a tar are read before the first frame of its shard.
    """

    def __init__(self, place: Place, shards: Sequence[Shard], all_shards: int) -> None:
        self.place = place
        self._shards = tuple(shards)
        self._all_shards = all_shards
        self._ends = np.cumsum([shard.images for shard in shards], dtype=np.int64)
        self._indices: dict[int, TarIndex] = {}

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_indices": {}}

    def __repr__(self) -> str:
        return f"<sharded dataset {self.place}: {len(self)} frames, {len(self._shards)} of {self._all_shards} shards>"

    def __len__(self) -> int:
        return int(self._ends[-1]) if len(self._ends) else 0

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Read a frame; default kinds: all stored ones."""
        number = int(np.searchsorted(self._ends, index, side="right"))
        shard = self._shards[number]
        tar = self._index_shard(number)
        position = index - int(self._ends[number]) + shard.images
        frame = int(tar.frames[position])
        there = tar.find_files(position)
        stored = [kind for kind in there if kind != RECORD]
        files = {}
        for kind in checked(frame, kinds, dict.fromkeys(stored)):
            files[kind] = decode_artifact(kind, self._read_file(shard.tar, frame, *there[kind]))
        if RECORD not in there:
            raise RenderError(f"{self.place}/{shard.tar} has no record", frame)
        return Frame(frame, files, self._read_file(shard.tar, frame, *there[RECORD]).decode())

    def _index_shard(self, number: int) -> TarIndex:
        if number not in self._indices:
            shard = self._shards[number]
            name = f"{self.place}/{shard.tar}"
            try:
                tar = index_tar(self.place, shard.tar)
            except ValueError as error:
                raise RenderError(f"{name} {error}") from error
            except FileNotFoundError as error:
                raise RenderError(f"{name} is gone; open the dataset again") from error
            if len(tar.frames) != shard.images:
                raise RenderError(f"{name} has {len(tar.frames)} images, its marker {shard.images}")
            self._indices[number] = tar
        return self._indices[number]

    def _read_file(self, tar: str, frame: int, begin: int, length: int) -> bytes:
        file = self.place.read(tar, begin, length)
        if len(file) != length:
            raise RenderError(f"{self.place}/{tar} ends within the frame", frame)
        return file


def open_sharded(place: Place) -> ShardedDataset | None:
    """Open the sharded dataset of a folder; `None` for another folder. Raises `FathomError` for another layout."""
    file = read_if_present(place, CARD)
    try:
        card = json.loads(file) if file is not None else None
    except ValueError:
        card = None
    if not isinstance(card, dict) or "format" not in card:
        return None
    if card["format"] != FORMAT:
        raise FathomError(f"{place} has the format {card['format']}; this version of fathom reads {FORMAT}")
    markers = [f"done/{name}" for name in place.list_names("done") if _MARKER.fullmatch(name)]
    files = place.read_files(markers)
    shards = [_read_marker(place, name, files[name]) for name in markers]
    all_shards = -(-int(card["frames"]) // int(card["frames_per_shard"]))
    return ShardedDataset(place, [shard for shard in shards if shard.images > 0], all_shards)


def _read_marker(place: Place, name: str, file: bytes) -> Shard:
    try:
        marker = json.loads(file)
        number, attempt, images = int(marker["shard"]), str(marker["attempt"]), int(marker["images"])
    except (ValueError, KeyError, TypeError) as error:
        raise FathomError(f"{place}/{name} cannot be read; delete it and render the shard again") from error
    if not _ATTEMPT.fullmatch(attempt):
        raise FathomError(f"{place}/{name} has the attempt `{attempt}`, which is not part of a file name")
    return Shard(f"shards/{number:06}-{attempt}.tar", images)
