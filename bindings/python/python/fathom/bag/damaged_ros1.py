"""ROS 1 bags without an index, or cut off: the records in the order of the file."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from rosbags.interfaces import Connection, ConnectionExtRosbag1, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag1.reader import Header, ReaderError, RecordType, decompressors, normalize, read_bytes, read_uint32
from rosbags.typesys.msg import normalize_msgtype

_MAGIC = b"#ROSBAG V2.0\n"
_Record = tuple[Header, int, bytes]


class DamagedRos1:
    """Reads a bag from its start to its first damage."""

    def __init__(self, path: Path) -> None:
        """Find the connections in the readable part."""
        self._path = path
        self.cut: str | None = None
        """Where the file is damaged, if it is."""
        found: dict[int, Connection] = {}
        for header, operation, data in self._read_records():
            if operation == RecordType.CONNECTION:
                connection = _read_connection(header, data, self)
                found.setdefault(connection.id, connection)
        self.connections = list(found.values())

    def close(self) -> None:
        """Do nothing: the file is only open during reading."""

    def messages(self, connections: Collection[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield the messages of some connections."""
        wanted = {connection.id: connection for connection in connections}
        for header, operation, data in self._read_records():
            if operation == RecordType.MSGDATA and header.get_uint32("conn") in wanted:
                yield wanted[header.get_uint32("conn")], header.get_time("time"), data

    def _read_records(self) -> Iterator[_Record]:
        """Yield the records, also those in chunks, up to the first damage."""
        with self._path.open("rb") as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                self.cut = "the file does not begin as a bag of version 2.0"
                return
            end = self._path.stat().st_size
            while file.tell() < end:
                position = file.tell()
                try:
                    header = Header.read(file)
                    if header.get_uint8("op") == RecordType.CHUNK:
                        yield from _read_chunk(header, file)
                    else:
                        yield _read_record(header, file)
                except ReaderError as error:
                    self.cut = f"damage at byte {position} of {end}: {error}"
                    return


def _read_chunk(header: Header, file: BinaryIO) -> Iterator[_Record]:
    size = read_uint32(file)
    data = file.read(size)
    compression = header.get_string("compression")
    if len(data) < size and compression != "none":
        raise ReaderError("the last chunk is incomplete")
    try:
        data = decompressors[compression](data)
    except (KeyError, OSError, RuntimeError, ValueError) as error:
        raise ReaderError(f"a chunk cannot be decompressed: {error}") from None
    chunk = BytesIO(data)
    while chunk.tell() < len(data):
        yield _read_record(Header.read(chunk), chunk)
    if len(data) < size and compression == "none":
        raise ReaderError("the last chunk is incomplete")


def _read_record(header: Header, file: BinaryIO) -> _Record:
    return header, header.get_uint8("op"), read_bytes(file, read_uint32(file))


def _read_connection(header: Header, data: bytes, owner: DamagedRos1) -> Connection:
    fields = Header.read(BytesIO(len(data).to_bytes(4, "little") + data))
    latching = fields.get_string("latching") if "latching" in fields else ""
    return Connection(
        header.get_uint32("conn"),
        normalize(header.get_string("topic")),
        normalize_msgtype(fields.get_string("type")),
        MessageDefinition(MessageDefinitionFormat.MSG, fields.get_string("message_definition")),
        fields.get_string("md5sum"),
        0,
        ConnectionExtRosbag1(
            fields.get_string("callerid") if "callerid" in fields else None, int(latching) if latching else None
        ),
        owner,
    )
