"""SQLite recordings that were not closed, or are cut off: the messages in the order of recording."""

from __future__ import annotations

import sqlite3
from collections.abc import Collection, Iterator
from pathlib import Path
from urllib.parse import quote

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinition, MessageDefinitionFormat
from rosbags.rosbag2.metadata import parse_qos

from fathom.bag.reader import describe_error

_FORMATS = {"ros2msg": MessageDefinitionFormat.MSG, "ros2idl": MessageDefinitionFormat.IDL}


class DamagedSqlite:
    """Reads a database up to its first damage, with the messages of its write-ahead log."""

    def __init__(self, path: Path) -> None:
        """Find the connections."""
        self.cut: str | None = None
        """Why the database cannot be read to its end, if so."""
        self.connections: list[Connection] = []
        self._database = sqlite3.connect(f"file:{quote(str(path.absolute()))}?mode=ro", uri=True)
        try:
            # Without this, SQLite refuses a file that is shorter than its header states.
            self._database.execute("PRAGMA writable_schema=ON")
            self._read_connections()
        except sqlite3.Error as error:
            self.cut = describe_error(error)

    def close(self) -> None:
        """Close the database."""
        self._database.close()

    def messages(self, connections: Collection[Connection]) -> Iterator[tuple[Connection, int, bytes]]:
        """Yield the messages of some connections."""
        wanted = {connection.id: connection for connection in connections}
        try:
            # Rows are in the order of recording; the index by time may be the damaged part.
            for topic, time_ns, data in self._database.execute("SELECT topic_id, timestamp, data FROM messages"):
                if topic in wanted:
                    yield wanted[topic], time_ns, data
        except sqlite3.Error as error:
            self.cut = describe_error(error)

    def _read_connections(self) -> None:
        columns = {row[1] for row in self._database.execute("PRAGMA table_info(topics)")}
        qos = "offered_qos_profiles" if "offered_qos_profiles" in columns else "''"
        digest = "type_description_hash" if "type_description_hash" in columns else "''"
        definitions = self._read_definitions()
        none = MessageDefinition(MessageDefinitionFormat.NONE, "")
        query = f"SELECT id, name, type, serialization_format, {qos}, {digest} FROM topics ORDER BY id"
        for number, topic, msgtype, serialization, profiles, type_digest in self._database.execute(query):
            extension = ConnectionExtRosbag2(serialization, parse_qos(profiles))
            definition = definitions.get(msgtype, none)
            self.connections.append(Connection(number, topic, msgtype, definition, type_digest, 0, extension, self))

    def _read_definitions(self) -> dict[str, MessageDefinition]:
        """Return the definitions by type; recordings before Iron have none."""
        if not self._database.execute("PRAGMA table_info(message_definitions)").fetchall():
            return {}
        query = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
        rows = self._database.execute(query).fetchall()
        return {name: MessageDefinition(_FORMATS[kind], text) for name, kind, text in rows if kind in _FORMATS}
