"""Topics of a written recording that are those of the one that was read."""

from __future__ import annotations

from typing import Any

from rosbags.interfaces import Connection, ConnectionExtRosbag1, ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag2.metadata import dump_qos_v8
from rosbags.rosbag2.storage_mcap import McapWriter, Schema, write_schema
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

_IDL_PART = "=" * 80 + "\n"


def add_copy(writer: Any, connection: Connection) -> Connection:
    """Add a topic with the type, the definition and the quality of service of a connection that was read."""
    if isinstance(connection.ext, ConnectionExtRosbag1):
        return _add_ros1(writer, connection, connection.ext)
    added: Connection
    for added in writer.connections:
        if (added.topic, added.msgtype, added.ext) == (connection.topic, connection.msgtype, connection.ext):
            return added
    digest = connection.digest or _hash_type(connection)
    if connection.msgdef.format is MessageDefinitionFormat.NONE or not digest:
        return _add_undefined(writer, connection, connection.ext)
    added = writer.add_connection(
        connection.topic,
        connection.msgtype,
        msgdef=connection.msgdef.data,
        rihs01=digest,
        serialization_format=connection.ext.serialization_format,
        offered_qos_profiles=connection.ext.offered_qos_profiles,
    )
    return added


def _add_ros1(writer: Any, connection: Connection, extension: ConnectionExtRosbag1) -> Connection:
    added: Connection
    for added in writer.connections:
        if (added.topic, added.msgtype, added.digest, added.ext) == (
            connection.topic,
            connection.msgtype,
            connection.digest,
            extension,
        ):
            return added
    added = writer.add_connection(
        connection.topic,
        connection.msgtype,
        msgdef=connection.msgdef.data,
        md5sum=connection.digest,
        callerid=extension.callerid,
        latching=extension.latching,
    )
    return added


def _hash_type(connection: Connection) -> str:
    """Return the hash of a type by its definition, empty for one that `rosbags` cannot read."""
    store = get_typestore(Stores.EMPTY)
    definition = connection.msgdef
    try:
        if definition.format is MessageDefinitionFormat.MSG:
            store.register(get_types_from_msg(definition.data, connection.msgtype))
        elif definition.data.startswith(f"{_IDL_PART}IDL: "):
            for part in definition.data.split(_IDL_PART)[1:]:
                store.register(get_types_from_idl(part.split("\n", 1)[1]))
        else:
            store.register(get_types_from_idl(definition.data))
        return store.hash_rihs01(connection.msgtype)
    except (TypesysError, KeyError, IndexError):
        return ""


def _add_undefined(writer: Any, connection: Connection, extension: ConnectionExtRosbag2) -> Connection:
    """Add a topic whose type has no readable definition, as recordings before Iron have them.

    `Writer.add_connection` needs a definition and its hash.
    """
    digest = connection.digest
    added = connection._replace(id=len(writer.connections) + 1, digest=digest, msgcount=0, owner=writer)
    if connection.msgtype not in writer.added_types:
        _add_undefined_type(writer.storage, added)
        writer.added_types.add(connection.msgtype)
    writer.storage.add_connection(added, dump_qos_v8(extension.offered_qos_profiles))
    writer.connections.append(added)
    writer.counts[added.id] = 0
    return added


def _add_undefined_type(storage: Any, connection: Connection) -> None:
    if connection.msgdef.format is not MessageDefinitionFormat.NONE:
        storage.add_msgtype(connection)
    elif isinstance(storage, McapWriter):
        # A channel names a schema, here one of unknown encoding.
        storage.schemas.append(Schema(len(storage.schemas) + 1, connection.msgtype, "", ""))
        write_schema(storage.chunk.bio, storage.schemas[-1])
