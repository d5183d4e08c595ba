"""A recording: ROS 1 bags, ROS 2 folders with SQLite or MCAP, and single files of these."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader as Ros1Reader
from rosbags.rosbag2 import Reader as Ros2Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from fathom.bag.damaged import open_damaged
from fathom.bag.errors import BagError
from fathom.bag.reader import Reader, describe_error
from fathom.messages.errors import MessageError

TRANSFORMS = "tf2_msgs/msg/TFMessage"
"""Type of `/tf` and `/tf_static`."""
Message = tuple[Connection, int, bytes]
"""A connection, the time of recording in nanoseconds, and the bytes of the message."""


class Kind(Enum):
    """Format of a recording."""

    ROS1 = "ROS 1"
    SQLITE = "ROS 2 with SQLite"
    MCAP = "ROS 2 with MCAP"


class Recording:
    """An open recording. Its messages can be read several times, in the order of recording."""

    def __init__(self, path: Path) -> None:
        """Open the recording; what is left of a damaged one. Raises `BagError` if nothing is."""
        self.path = path
        self.cut: str | None = None
        """Why the recording ends early, once that is known."""
        self.end_ns: int | None = None
        """Time of recording of the last message that was read."""
        self.kind = find_kind(path)
        self._readers = self._open()
        self.connections: list[Connection] = [
            connection for reader in self._readers for connection in reader.connections
        ]
        self._store = _load_types(self.kind is Kind.ROS1)

    def close(self) -> None:
        """Close the files."""
        for reader in self._readers:
            reader.close()

    def __enter__(self) -> Recording:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def messages(self, connections: Collection[Connection] | None = None) -> Iterator[Message]:
        """Yield the messages of some connections, or of all, up to the end or to the first damage."""
        for reader in self._readers:
            own = [each for each in reader.connections if connections is None or each in connections]
            if not own:
                continue
            try:
                for message in reader.messages(own):
                    self.end_ns = max(message[1], self.end_ns or 0)
                    yield message
            except GeneratorExit:
                raise
            except Exception as error:
                # Damaged files make the libraries below raise errors of any type.
                self.cut = self.cut or describe_error(error)
            self.cut = getattr(reader, "cut", None) or self.cut

    def find(self, topic: str) -> list[Connection]:
        """Return the connections of a topic; raises `BagError` with the topics of the recording."""
        found = [connection for connection in self.connections if connection.topic == topic]
        if found:
            return found
        names = sorted({f"{each.topic} ({each.msgtype})" for each in self.connections})
        listed = "\n  ".join(names) if names else "none"
        raise BagError(f"{self.path} has no topic {topic}; its topics are\n  {listed}")

    def deserialize(self, connection: Connection, data: bytes) -> Any:
        """Return the message of one of the standard types; raises `MessageError`."""
        try:
            if self.kind is Kind.ROS1:
                return self._store.deserialize_ros1(data, connection.msgtype)
            return self._store.deserialize_cdr(data, connection.msgtype)
        except Exception as error:
            # The library raises errors of many types for bytes that are no message of the type.
            reason = f"the message cannot be read: {describe_error(error)}"
            raise MessageError(connection.topic, reason, "unreadable message") from None

    def serialize(self, message: Any, msgtype: str) -> memoryview:
        """Return the bytes of a message of one of the standard types."""
        serialize = self._store.serialize_ros1 if self.kind is Kind.ROS1 else self._store.serialize_cdr
        data: memoryview = serialize(message, msgtype)
        return data

    def message_type(self, msgtype: str) -> type[Any]:
        """Return the class of messages of a standard type."""
        message_type: type[Any] = self._store.types[msgtype]
        return message_type

    @property
    def store(self) -> Any:
        """The standard types of this kind."""
        return self._store

    def _open(self) -> list[Reader]:
        reason = "a write-ahead log shows that it was not closed"
        if not _has_log(self.path):
            try:
                return [self._open_whole(self.path)]
            except PermissionError as error:
                raise BagError(f"{self.path}: {error.strerror}") from None
            except Exception as error:
                reason = describe_error(error)
        files = [self.path] if self.path.is_file() else list_storage(self.path)
        readers = [self._open_part(file, reason) for file in files]
        if not any(reader.connections for reader in readers):
            raise BagError(f"{self.path} has no readable message: {self.cut}")
        return readers

    def _open_whole(self, path: Path) -> Reader:
        reader = Ros1Reader(path) if self.kind is Kind.ROS1 else Ros2Reader(path)
        reader.open()
        return reader

    def _open_part(self, file: Path, reason: str) -> Reader:
        """Open a file of a folder, which may be complete without the folder's `metadata.yaml`."""
        if file != self.path and not _has_log(file) and not file.name.endswith(".zstd"):
            try:
                return self._open_whole(file)
            except Exception as error:
                reason = describe_error(error)
        damaged = open_damaged(file)
        self.cut = damaged.cut or reason
        return damaged


@cache
def _load_types(is_ros1: bool) -> Any:
    store = get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.ROS2_HUMBLE)
    if TRANSFORMS not in store.types:
        # The library has the types of ROS 1 without that of `/tf`.
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", TRANSFORMS))
    return store


def find_kind(path: Path) -> Kind:
    """Return the kind of a recording by its name or the files in its folder; raises `BagError`."""
    if not path.exists():
        raise BagError(f"{path} does not exist")
    file = path
    if path.is_dir():
        files = list_storage(path)
        if not files:
            raise BagError(f"{path} holds no .mcap or .db3 file; give a .bag file or the folder of a ROS 2 recording")
        file = files[0]
    kind = kind_of_name(file.name)
    if kind is None:
        raise BagError(
            f"{path} is no recording; must be a .bag, .mcap or .db3 file, or the folder of a ROS 2 recording"
        )
    return kind


def kind_of_name(name: str) -> Kind | None:
    """Return the kind that the end of a name states."""
    ends = {".bag": Kind.ROS1, ".bag.active": Kind.ROS1, ".db3": Kind.SQLITE, ".mcap": Kind.MCAP}
    name = name.removesuffix(".zstd")
    return next((kind for end, kind in ends.items() if name.endswith(end)), None)


def list_storage(folder: Path) -> list[Path]:
    """Return the files of messages in the folder of a ROS 2 recording, in the order of recording."""
    ends = (".db3", ".mcap", ".db3.zstd", ".mcap.zstd")
    files = [path for path in folder.iterdir() if path.name.endswith(ends)]
    # The number of a part stands at the end: bag_9.mcap is before bag_10.mcap.
    return sorted(files, key=_read_part_number)


def _read_part_number(path: Path) -> tuple[int, str]:
    digits = path.name.split(".")[0].rpartition("_")[2]
    return (int(digits) if digits.isdecimal() else -1, path.name)


def _has_log(path: Path) -> bool:
    """Whether messages are still in the log of a database, which readers of single files pass over."""
    files = [path] if path.is_file() else list_storage(path)
    logs = [file.with_name(f"{file.name}-wal") for file in files]
    return any(log.exists() and log.stat().st_size > 0 for log in logs)
