"""MCAP files without an index, or cut off: the complete records in the order of the file."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path

from rosbags.interfaces import Connection
from rosbags.rosbag2.storage_mcap import McapReader

from fathom.bag.reader import describe_error

_MAGIC = b"\x89MCAP0\r\n"
_HEAD = 9
"""Bytes before the content of a record: its type and its size."""
_DATA_END = 0x0F
"""Type of the record after the last message."""


class DamagedMcap:
    """Reads a file from its start to its first incomplete record."""

    def __init__(self, path: Path) -> None:
        """Find the connections in the readable part."""
        self._reader = McapReader(path)
        self.cut: str | None = None
        """Where the file is damaged, if it is."""
        self._reader.bio = path.open("rb")
        self._reader.data_start = len(_MAGIC)
        self._reader.data_end = self._find_end(path.stat().st_size)
        if self._reader.data_end > self._reader.data_start:
            try:
                self._reader.meta_scan()
            except Exception as error:
                # The connections before the damage are known; reading messages ends there.
                self.cut = describe_error(error)

    @property
    def connections(self) -> list[Connection]:
        """The connections in the readable part."""
        return self._reader.connections

    def close(self) -> None:
        """Close the file."""
        self._reader.close()

    def messages(self, connections: Collection[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield the messages of some connections."""
        yield from self._reader.messages_scan(connections)

    def _find_end(self, size: int) -> int:
        """Return the end of the last complete record."""
        file = self._reader.bio
        assert file is not None
        if file.read(len(_MAGIC)) != _MAGIC:
            self.cut = "the file does not begin as an MCAP file"
            return 0
        end = len(_MAGIC)
        while end + _HEAD <= size:
            file.seek(end)
            head = file.read(_HEAD)
            record = _HEAD + int.from_bytes(head[1:], "little")
            if head[0] == _DATA_END:
                return end
            if end + record > size:
                break
            end += record
        self.cut = f"the record at byte {end} of {size} is incomplete"
        return end
