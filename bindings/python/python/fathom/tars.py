"""Positions of the files in a tar of a sharded dataset."""

from __future__ import annotations

import re
import tarfile
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fathom.places import Place, ReadRange

BLOCK = tarfile.BLOCKSIZE
RECORD = ""
"""Kind of the record."""
_MEMBER = re.compile(r"(?P<frame>\d{12,})\.(?:(?P<kind>[^/]+)\.)?[a-z0-9]+")


@dataclass(frozen=True)
class TarIndex:
    """Frames of a tar and the positions of their files, about 20 bytes a file."""

    frames: NDArray[np.int64]
    _starts: NDArray[np.int64]
    _kinds: NDArray[np.int16]
    _offsets: NDArray[np.int64]
    _lengths: NDArray[np.int64]
    _names: tuple[str, ...]

    def find_files(self, position: int) -> dict[str, tuple[int, int]]:
        """Return begin and length of each file of a frame by kind; the kind of the record is `RECORD`."""
        files = range(self._starts[position], self._starts[position + 1])
        return {self._names[self._kinds[file]]: (int(self._offsets[file]), int(self._lengths[file])) for file in files}


def index_tar(place: Place, name: str) -> TarIndex:
    """Read the headers of a tar, whose files are in the order of their frames. Raises `ValueError` for another file."""
    names: dict[str, int] = {}
    frames: list[int] = []
    starts: list[int] = []
    rows: list[tuple[int, int, int]] = []
    with place.open_file(name) as read:
        for header in _read_headers(read, place.read_ahead):
            member = _MEMBER.fullmatch(header.name)
            if member is None:
                raise ValueError(f"contains `{header.name}`, which is not the file of a frame")
            frame = int(member["frame"])
            if not frames or frames[-1] != frame:
                frames.append(frame)
                starts.append(len(rows))
            kind = member["kind"] or RECORD
            rows.append((names.setdefault(kind, len(names)), header.offset, header.size))
    table = np.array(rows, np.int64).reshape(-1, 3)
    return TarIndex(
        np.array(frames, np.int64),
        np.array([*starts, len(rows)], np.int64),
        table[:, 0].astype(np.int16),
        table[:, 1].copy(),
        table[:, 2].copy(),
        tuple(names),
    )


@dataclass(frozen=True)
class _Header:
    name: str
    offset: int
    size: int


def _read_headers(read: ReadRange, read_ahead: int) -> Iterator[_Header]:
    """Yield the headers of a tar up to its end mark, with as few reads as possible."""
    window, window_begin, place = b"", 0, 0
    while True:
        begin = place - window_begin
        if begin + BLOCK > len(window):
            window, window_begin, begin = read(place, read_ahead), place, 0
        block = window[begin : begin + BLOCK]
        if block == bytes(BLOCK):
            return
        try:
            header = tarfile.TarInfo.frombuf(block, "utf-8", "strict")
        except tarfile.HeaderError as error:
            raise ValueError(f"is damaged at byte {place}: {error}") from error
        place += BLOCK
        yield _Header(header.name, place, header.size)
        place += -(-header.size // BLOCK) * BLOCK
