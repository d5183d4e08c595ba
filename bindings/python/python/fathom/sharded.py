"""Frames in tars: a folder of `fathom export --format webdataset`, here or at a URL that fsspec reads."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from fathom.errors import RenderError
from fathom.frame import Frame
from fathom.lines import Lines
from fathom.stored import checked, decode_artifact

_TAR = re.compile(r"\d{6,}\.tar")
_OFFSET = re.compile(r"artifacts\.(.+)\.offset")


class Place(Protocol):
    """Location of the tars."""

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file."""


class Local:
    """A folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file."""
        with (self.folder / name).open("rb") as file:
            file.seek(begin)
            return file.read(length)


class Remote:
    """A folder at a URL such as `s3://bucket/set`; every reading process opens its connection."""

    def __init__(self, url: str) -> None:
        self.url = url.rstrip("/")
        self._files: tuple[int, Any, str] | None = None

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_files": None}

    def _open(self) -> tuple[Any, str]:
        if self._files is None or self._files[0] != os.getpid():
            try:
                import fsspec
            except ImportError as error:
                raise ImportError(f"{self.url} is read by fsspec: pip install fathom-datasets[buckets]") from error
            self._files = os.getpid(), *fsspec.url_to_fs(self.url)
        return self._files[1:]

    def read(self, name: str, begin: int, length: int) -> bytes:
        """Return a range of a file."""
        files, folder = self._open()
        part: bytes = files.cat_file(f"{folder}/{name}", start=begin, end=begin + length)
        return part

    def lines(self, name: str) -> list[bytes]:
        """Return the lines of a file."""
        files, folder = self._open()
        text: bytes = files.cat_file(f"{folder}/{name}")
        return text.splitlines()


class Sharded:
    """Frames in tars. Each line of the list holds the tar of a frame and the offsets of its files."""

    def __init__(self, place: Place, rows: Lines | list[bytes]) -> None:
        self.place = place
        self._rows = rows

    def __len__(self) -> int:
        return len(self._rows)

    def read(self, index: int, kinds: Sequence[str] | None = None) -> Frame:
        """Read a frame; default kinds: all exported ones."""
        line = self._rows[index]
        row: Mapping[str, Any] = json.loads(line) if isinstance(line, bytes) else line
        number = int(row.get("frame", index))
        there = {found[1]: column for column in row if (found := _OFFSET.fullmatch(column))}
        files = {}
        for kind in checked(number, kinds, there):
            files[kind] = decode_artifact(kind, self._file(number, row, f"artifacts.{kind}"))
        record = self._file(number, row, "record") if "record.offset" in row else json.dumps(dict(row)).encode()
        return Frame(number, files, record.decode())

    def _file(self, frame: int, row: Mapping[str, Any], column: str) -> bytes:
        tar = str(row.get("tar"))
        if not _TAR.fullmatch(tar):
            raise RenderError(f"{tar} is not the name of a tar of the folder", frame)
        begin, length = int(row[f"{column}.offset"]), int(row[f"{column}.bytes"])
        file = self.place.read(tar, begin, length)
        if len(file) != length:
            raise RenderError(f"{tar} ends within {column}", frame)
        return file
