"""GridMap messages of ROS 1 bags, ROS 2 bags and MCAP files as heights, by rosbags, without ROS."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.terrain.foreign.answers import Answer, RefusedError
from jaxleas.terrain.foreign.ros1_mcap import deserialised, is_ros1, last_messages

MAX_CELLS = 64_000_000
TYPE = "grid_map_msgs/msg/GridMap"
USUAL_LAYER = "elevation"
# Of ROS 2 bags that carry no definitions (before Iron).
INFO = "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n"
GRID_MAP = (
    "std_msgs/Header header\ngrid_map_msgs/GridMapInfo info\nstring[] layers\n"
    "string[] basic_layers\nstd_msgs/Float32MultiArray[] data\nuint16 outer_start_index\n"
    "uint16 inner_start_index\n"
)


def load() -> None:
    """Load the library."""
    import rosbags.highlevel  # noqa: F401


def read(path: Path, options: dict[str, Any]) -> Answer:
    """Return `heights` [rows = y, columns = x], `resolution` and `origin` of the last message.

    Args:
        path: a .bag, .mcap or .db3 file, or the folder of a ROS 2 bag.
        options: `topic` and `layer`, or None: the only topic, and the layer "elevation".
    """
    ros1 = path.suffix.lower() == ".mcap" and path.is_file() and is_ros1(path)
    topic, number, message = (_last_of_ros1 if ros1 else _last)(path, options.get("topic"))
    layer = _layer(list(message.layers), options.get("layer"))
    notes = [f"is read on the topic {topic}, layer {message.layers[layer]}"]
    if number > 1:
        notes[0] += f", the last of {number} messages"
    return Answer(_arrays(message, layer), notes)


def _last(path: Path, topic: str | None) -> tuple[str, int, Any]:
    """Return the topic, the number of its messages, and the last of them, by rosbags."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(INFO, "grid_map_msgs/msg/GridMapInfo"))
    store.register(get_types_from_msg(GRID_MAP, TYPE))
    with AnyReader([path], default_typestore=store) as reader:
        connections = _on_topic(reader.connections, topic)
        number, last = 0, None
        for connection, _, raw in reader.messages(connections=connections):
            number, last = number + 1, (connection, raw)
        if last is None:
            raise RefusedError(f"has no message on the topic {connections[0].topic}")
        return connections[0].topic, number, reader.deserialize(last[1], last[0].msgtype)


def _last_of_ros1(path: Path, topic: str | None) -> tuple[str, int, Any]:
    """Return the same of an MCAP file with messages of ROS 1."""
    found = last_messages(path)
    chosen = _on_topic([each for each, _, _ in found], topic)[0]
    number, raw = next((number, raw) for each, number, raw in found if each == chosen)
    if not number:
        raise RefusedError(f"has no message on the topic {chosen.topic}")
    return chosen.topic, number, deserialised(chosen, raw)


def _on_topic(connections: list[Any], topic: str | None) -> list[Any]:
    maps = [each for each in connections if each.msgtype == TYPE]
    topics = sorted({each.topic for each in maps})
    if not topics:
        others = sorted({each.msgtype for each in connections})
        raise RefusedError(f"holds no GridMap; it holds {', '.join(others)[:120] or 'nothing'}")
    if topic is None and len(topics) > 1:
        raise RefusedError(f"has maps on several topics: say --topic, one of {', '.join(topics)}")
    if topic is not None and topic not in topics:
        raise RefusedError(f"has no map on the topic {topic}; there are {', '.join(topics)}")
    return [each for each in maps if each.topic == (topic or topics[0])]


def _layer(layers: list[str], layer: str | None) -> int:
    wanted = layer or (USUAL_LAYER if USUAL_LAYER in layers else None)
    if wanted is None and len(layers) == 1:
        wanted = layers[0]
    if wanted is None:
        raise RefusedError(f"says nothing of elevation: say --layer, one of {', '.join(layers)}")
    if wanted not in layers:
        raise RefusedError(f"has no layer {wanted}; there are {', '.join(layers)}")
    return layers.index(wanted)


def _arrays(message: Any, layer: int) -> dict[str, Any]:
    """Return a layer as a map.

    Row 0 of a GridMap lies at the largest x, column 0 at the largest y, both before the buffer
    was moved round by its start indices.
    """
    data = message.data[layer]
    labels = [each.label for each in data.layout.dim]
    if len(labels) != 2 or set(labels) != {"column_index", "row_index"}:
        raise RefusedError(f"has data with the dimensions {', '.join(labels)}")
    outer, inner = (int(each.size) for each in data.layout.dim)
    values = np.asarray(data.data, np.float32)[int(data.layout.data_offset) :]
    if outer * inner > MAX_CELLS or len(values) != outer * inner:
        raise RefusedError(f"has {len(values)} values for {outer} x {inner} cells")
    matrix = values.reshape(outer, inner)
    if labels[0] == "column_index":
        matrix = matrix.T
    start = int(message.outer_start_index), int(message.inner_start_index)
    if start[0] >= matrix.shape[0] or start[1] >= matrix.shape[1]:
        raise RefusedError(f"begins at cell {start} of {matrix.shape[0]} x {matrix.shape[1]}")
    matrix = np.roll(matrix, (-start[0], -start[1]), axis=(0, 1))
    info, pose = message.info, message.info.pose
    if abs(pose.orientation.x) + abs(pose.orientation.y) + abs(pose.orientation.z) > 1e-6:
        raise RefusedError("has a map that is turned in its frame")
    lengths = np.array(matrix.shape) * info.resolution
    if np.abs(lengths - [info.length_x, info.length_y]).max() > info.resolution:
        raise RefusedError(f"states a map of {info.length_x:g} x {info.length_y:g} m for its cells")
    middle = np.array([pose.position.x, pose.position.y])
    return {
        "heights": matrix[::-1, ::-1].T,
        "resolution": info.resolution,
        "origin": middle - 0.5 * lengths + 0.5 * info.resolution,
    }
