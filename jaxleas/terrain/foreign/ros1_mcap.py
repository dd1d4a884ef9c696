"""MCAP files (mcap.dev/spec) with messages of ROS 1, which rosbags does not read."""

import struct
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

from jaxleas.terrain.foreign.answers import RefusedError

MAGIC = b"\x89MCAP0\r\n"
MOST = 2**30
"""Largest size of an unpacked chunk [bytes]."""
_HEADER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 1, 3, 4, 5, 6, 15


class Connection(NamedTuple):
    """A topic of a file.

    Attributes:
        topic: name of the topic.
        msgtype: type of its messages, in the words of ROS 2.
        definition: text of the type's definition, in the words of ROS 1.
    """

    topic: str
    msgtype: str
    definition: str


def is_ros1(path: Path) -> bool:
    """Return whether an MCAP file says that its messages are those of ROS 1."""
    with path.open("rb") as file:
        start = BytesIO(file.read(256))
    if start.read(len(MAGIC)) != MAGIC or start.read(1) != bytes([_HEADER]):
        return False
    start.read(8)
    return _text(start) == "ros1"


def last_messages(path: Path) -> list[tuple[Connection, int, bytes]]:
    """Return each topic, the number of its messages, and the last of them."""
    schemas: dict[int, tuple[str, str]] = {}
    topics: dict[int, Connection] = {}
    found: dict[int, tuple[int, int, bytes]] = {}
    for kind, body in _records(path.read_bytes()[len(MAGIC) :]):
        content = BytesIO(body)
        number = _number(content, "<H")
        if kind == _SCHEMA:
            name, _ = _text(content), _text(content)
            schemas[number] = (name, _text(content))
        elif kind == _CHANNEL:
            schema = _number(content, "<H")
            topic, encoding = _text(content), _text(content)
            if encoding != "ros1" or schema not in schemas:
                continue
            name, definition = schemas[schema]
            package, _, short = name.rpartition("/")
            topics[number] = Connection(topic, f"{package}/msg/{short}", definition)
        elif number in topics:
            _, time, _ = struct.unpack("<IQQ", content.read(20))
            count, latest, raw = found.get(number, (0, -1, b""))
            newer = time >= latest
            found[number] = (count + 1, max(time, latest), content.read() if newer else raw)
    last = {number: found.get(number, (0, -1, b"")) for number in topics}
    return [(topics[number], count, raw) for number, (count, _, raw) in last.items()]


def deserialised(connection: Connection, raw: bytes) -> Any:
    """Return a message of a topic."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(connection.definition, connection.msgtype))
    return store.deserialize_ros1(raw, connection.msgtype)


def _records(content: bytes, packed: bool = False) -> Iterator[tuple[int, bytes]]:
    """Yield kind and body of schemas, channels and messages up to the end of the data.

    Args:
        content: records, one after another.
        packed: whether they come from a chunk, in which there is no other one.
    """
    at = 0
    while at + 9 <= len(content):
        kind, length = struct.unpack_from("<BQ", content, at)
        body = content[at + 9 : at + 9 + length]
        if len(body) < length:
            raise RefusedError("ends within a record")
        at += 9 + length
        if kind == _DATA_END:
            return
        if kind == _CHUNK and not packed:
            yield from _records(_unpacked(body), packed=True)
        elif kind in (_SCHEMA, _CHANNEL, _MESSAGE):
            yield kind, body


def _unpacked(chunk: bytes) -> bytes:
    content = BytesIO(chunk)
    content.read(16)  # times of its first and last message
    size = _number(content, "<Q")
    content.read(4)  # checksum
    if size > MOST:
        raise RefusedError(f"has a chunk of {size} bytes, more than {MOST}")
    packing, length = _text(content), _number(content, "<Q")
    packed = content.read(length)
    if not packing:
        return packed
    from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

    if packing not in DECOMPRESSORS:
        raise RefusedError(f"has a chunk packed as {packing!r:.20}, which is not read")
    unpacked = DECOMPRESSORS[packing](packed, size)
    if len(unpacked) != size:
        raise RefusedError(f"has a chunk of {len(unpacked)} bytes that should be {size}")
    return unpacked


def _number(content: BytesIO, form: str) -> int:
    return int(struct.unpack(form, content.read(struct.calcsize(form)))[0])


def _text(content: BytesIO) -> str:
    return content.read(_number(content, "<I")).decode()
