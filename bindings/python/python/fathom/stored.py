"""Stored frames: a folder of `fathom render`, an exported one, a dataset of a service."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fathom import _native
from fathom.errors import InvalidArgument, MissingFrames, RenderError
from fathom.frame import Frame
from fathom.frames import Frames, Source
from fathom.lines import Lines
from fathom.places import Local, Remote, find_place, read_if_present

EXTENSIONS = {
    "image/png": "png",
    "image/webp": "webp",
    "image/jpeg": "jpg",
    "application/x-npy": "npy",
    "application/json": "json",
}
"""The extension of a file by its media type."""

_KIND = re.compile(r"[a-z][a-z0-9_.]*")
_NUMBER = re.compile(r"^\d{12}\.")


def open(place: str | os.PathLike[str] | Source) -> Frames:
    """Open stored frames as `Frames`.

    `place` is a folder of `fathom render`, with or without shards, a folder of `fathom export`, or the result of
    `Client.dataset`. A sharded dataset and an export in the format webdataset may also be at a URL such as
    `s3://bucket/set`, which fsspec reads. Only frames with an image are in the sequence, in the order of the list or of
    the shards; those of a sharded dataset are the shards complete at this moment.
    """
    from fathom.sharded import Sharded
    from fathom.sharded_dataset import CARD, open_sharded

    if not isinstance(place, (str, os.PathLike)):
        return Frames(place)
    there = find_place(place)
    if isinstance(there, Local) and (there.folder / Rendered.LIST).is_file():
        return Frames(Rendered(there.folder))
    if (dataset := open_sharded(there)) is not None:
        return Frames(dataset)
    missing = f"{there} holds neither {Rendered.LIST} nor {Exported.LIST}, nor the {CARD} of a sharded dataset"
    if isinstance(there, Remote):
        listed = read_if_present(there, Exported.LIST)
        if listed is None:
            raise MissingFrames(missing)
        return Frames(Sharded(there, listed.splitlines()))
    folder = there.folder
    if not (folder / Exported.LIST).is_file():
        raise MissingFrames(missing)
    rows = Lines(folder / Exported.LIST)
    first = rows[0] if len(rows) > 0 else {}
    if "tar" in first:
        return Frames(Sharded(there, rows))
    if "parquet" in first:
        raise InvalidArgument(f"{folder} holds Parquet files: read {folder / 'data'} with pyarrow, DuckDB or datasets")
    if "mcap" in first:
        raise InvalidArgument(f"{folder} holds recordings of ROS 2: read its .mcap files with mcap or rosbags")
    return Frames(Exported(folder))


def decode_artifact(kind: str, file: bytes) -> NDArray[Any] | str:
    """Return the array of a stored artifact, the text of a JSON one; a range is in meters, NaN where there is none."""
    if file[:1] in (b"{", b"["):
        return file.decode()
    array = _native.decode(file)
    if kind != "range":
        return array
    meters: NDArray[np.float32] = array.astype(np.float32) / np.float32(1000)
    meters[array == 0] = np.nan
    return meters


class Rendered:
    """A folder of `fathom render`: FRAME/KIND.EXTENSION, and one record a line."""

    LIST = "records.jsonl"

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._records = Lines(folder / self.LIST)

    def __repr__(self) -> str:
        return f"<rendered folder {self.folder}: {len(self)} frames>"

    def __len__(self) -> int:
        return len(self._records)

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Read a frame; default kinds: all stored ones."""
        record = self._records[index]
        number = int(record["frame"])
        types = {artifact["kind"]: artifact["media_type"] for artifact in record["artifacts"]}
        files = {}
        for kind in checked(number, kinds, types):
            path = self.folder / str(number) / f"{kind}.{EXTENSIONS[types[kind]]}"
            files[kind] = decode_artifact(kind, path.read_bytes())
        return Frame(number, files, json.dumps(record))


class Exported:
    """A folder of `fathom export`, or of a part of it.

    Each line is a row of columns, which names files JOB/FRAME/KIND.EXTENSION.
    """

    LIST = "metadata.jsonl"

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._rows = Lines(folder / self.LIST)

    def __repr__(self) -> str:
        return f"<exported folder {self.folder}: {len(self)} frames>"

    def __len__(self) -> int:
        return len(self._rows)

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Read a frame; default kinds: all exported ones. Its record is the row."""
        row = self._rows[index]
        paths = dict(_files(row))
        number = int(row.get("frame", index))
        files = {}
        for kind in checked(number, kinds, paths):
            path = (self.folder / paths[kind]).resolve()
            if not path.is_relative_to(self.folder):
                raise RenderError(f"{paths[kind]} is outside of the folder", number)
            files[kind] = decode_artifact(kind, path.read_bytes())
        return Frame(number, files, json.dumps(row))


def _files(row: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield kind and path of each file of a row; the first is `file_name`."""
    if isinstance(files := row.get("files"), Mapping):
        # Formats of sequences name files by time.
        yield from files.items()
        return
    for column, value in row.items():
        if isinstance(value, str) and "/" in value:
            # Files of a sequence begin with the number of their frame.
            kind = _NUMBER.sub("", value.rsplit("/", 1)[1]).rpartition(".")[0]
            if column in ("file_name", kind):
                yield kind, value


def checked(frame: int, kinds: Sequence[str] | None, there: Mapping[str, Any]) -> Sequence[str]:
    """Return the requested kinds after checking that all exist."""
    wanted = tuple(there) if kinds is None else kinds
    for kind in wanted:
        if kind not in there or not _KIND.fullmatch(kind):
            raise RenderError(f"there is no artifact `{kind}`; there is {', '.join(there)}", frame)
    return wanted
