"""A recording that is being written: under a temporary name, and renamed when it is complete."""

from __future__ import annotations

import secrets
import shutil
from pathlib import Path
from typing import Any, Literal

from rosbags.convert import ConverterError
from rosbags.convert.converter import convert
from rosbags.interfaces import Connection, ConnectionExtRosbag1
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Ros2Writer

from fathom.bag.copied import add_copy
from fathom.bag.errors import BagError
from fathom.bag.recording import Kind, Recording, kind_of_name

_VERSION: Literal[8] = 8
"""Version of ROS 2 folders; Iron and later read it."""


class Output:
    """Copies messages of a recording and adds others."""

    def __init__(self, path: Path, recording: Recording) -> None:
        """Choose the kind that the name states; raises `BagError` if it exists."""
        self._path = path
        self._recording = recording
        self._kind = _choose_kind(path, recording.kind)
        if path.exists():
            raise BagError(f"{path} exists; choose another name, or remove it")
        # The types of the messages are those of the recording; another kind is converted at the end.
        self._is_ros1 = recording.kind is Kind.ROS1
        self._folder = path.parent / f".fathom-bag-{secrets.token_hex(4)}"
        self._writer: Any = None
        self._copies: dict[int, Connection] = {}
        self._added: dict[str, Connection] = {}

    def begin(self) -> None:
        """Create the files; `finish` or `discard` removes all that are temporary. Raises `BagError`."""
        try:
            self._folder.mkdir(parents=True)
        except OSError as error:
            raise BagError(f"{self._path}: {error.strerror}") from None
        self._writer = self._open_writer()
        for connection in self._recording.connections:
            self._copies[id(connection)] = add_copy(self._writer, connection)

    def copy(self, connection: Connection, recorded_ns: int, data: bytes) -> None:
        """Write a message of the recording as it is."""
        self._writer.write(self._copies[id(connection)], recorded_ns, data)

    def add_topic(self, topic: str, msgtype: str, like: Connection) -> None:
        """Add a topic with the quality of service of another one; raises `BagError` if there is one of its name."""
        if any(connection.topic == topic for connection in self._recording.connections):
            raise BagError(f"{self._recording.path} already has the topic {topic}; convert the recording before it")
        extension, store = like.ext, self._recording.store
        if isinstance(extension, ConnectionExtRosbag1):
            self._added[topic] = self._writer.add_connection(topic, msgtype, typestore=store)
        else:
            profiles = extension.offered_qos_profiles
            self._added[topic] = self._writer.add_connection(
                topic, msgtype, typestore=store, offered_qos_profiles=profiles
            )

    def has_topic(self, topic: str) -> bool:
        """Whether the topic was added."""
        return topic in self._added

    def add(self, topic: str, recorded_ns: int, message: Any) -> None:
        """Write a message of an added topic."""
        connection = self._added[topic]
        self._writer.write(connection, recorded_ns, self._recording.serialize(message, connection.msgtype))

    def finish(self) -> None:
        """Complete the files and give them their name."""
        try:
            self._writer.close()
            written = self._writer.path
            if self._is_ros1 != (self._kind is Kind.ROS1):
                written = self._convert(written)
            if written.is_dir() and kind_of_name(self._path.name) is not None:
                written = next(file for file in written.iterdir() if file.suffix in (".mcap", ".db3"))
            written.rename(self._path)
        finally:
            self._remove_folder()

    def discard(self) -> None:
        """Remove what was written."""
        try:
            if self._writer is not None:
                self._writer.abort()
        finally:
            self._remove_folder()

    def _open_writer(self) -> Any:
        place = self._folder / self._path.name.removesuffix(".mcap").removesuffix(".db3").removesuffix(".bag")
        if self._is_ros1:
            writer: Any = Ros1Writer(place.with_name(f"{place.name}.bag"))
        else:
            writer = Ros2Writer(
                place, version=_VERSION, storage_plugin=_choose_plugin(self._kind, self._recording.kind)
            )
        writer.open()
        return writer

    def _convert(self, written: Path) -> Path:
        """Convert the messages between ROS 1 and ROS 2."""
        place = self._folder / "converted" / self._path.name.removesuffix(".mcap").removesuffix(".db3")
        place.parent.mkdir()
        storage = "mcap" if self._kind is Kind.MCAP else "sqlite3"
        default = self._recording.store
        try:
            convert([written], place, storage, _VERSION, None, "none", default, None, (), (), (), ())
        except ConverterError as error:
            raise BagError(f"{self._path}: a topic has no type there: {error}; name a file of the same kind") from None
        return place

    def _remove_folder(self) -> None:
        shutil.rmtree(self._folder, ignore_errors=True)


def _choose_kind(path: Path, given: Kind) -> Kind:
    """Return the kind of the name; a folder has the kind of the recording, or MCAP for that of ROS 1."""
    named = kind_of_name(path.name)
    if named is not None:
        return named
    return Kind.MCAP if given is Kind.ROS1 else given


def _choose_plugin(kind: Kind, given: Kind) -> StoragePlugin:
    """Return the storage of messages of ROS 2, also of those that become ROS 1 at the end."""
    is_mcap = kind is Kind.MCAP or (kind is Kind.ROS1 and given is Kind.MCAP)
    return StoragePlugin.MCAP if is_mcap else StoragePlugin.SQLITE3
