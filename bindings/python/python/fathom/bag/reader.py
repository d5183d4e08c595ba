"""What a recording needs of the readers of its files."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Protocol

from rosbags.interfaces import Connection


class Reader(Protocol):
    """A reader of one file or folder; also those of `rosbags`."""

    @property
    def connections(self) -> list[Connection]:
        """The connections."""

    def messages(self, connections: Collection[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield messages."""

    def close(self) -> None:
        """Close the file."""


def describe_error(error: Exception) -> str:
    """Return the reason of a library in one line."""
    text = " ".join(str(error).split()).rstrip(".")
    return text or type(error).__name__
