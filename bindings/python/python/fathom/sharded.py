"""Frames in tars: a folder of `fathom export --format webdataset`, here or at a URL that fsspec reads."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from fathom.errors import RenderError
from fathom.frame import Frame
from fathom.lines import Lines
from fathom.places import Place
from fathom.stored import checked, decode_artifact

_TAR = re.compile(r"\d{6,}\.tar")
_OFFSET = re.compile(r"artifacts\.(.+)\.offset")


class Sharded:
    """Frames in tars. Each line of the list holds the tar of a frame and the offsets of its files."""

    def __init__(self, place: Place, rows: Lines | list[bytes]) -> None:
        self.place = place
        self._rows = rows

    def __repr__(self) -> str:
        return f"<exported tars {self.place}: {len(self)} frames>"

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
