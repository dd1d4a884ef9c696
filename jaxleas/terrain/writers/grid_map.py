"""Height maps as GridMap messages in bags: ROS 1, ROS 2 and MCAP, by rosbags, without ROS."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.files import atomic_path
from jaxleas.terrain.foreign.grid_map import GRID_MAP, INFO, TYPE, USUAL_LAYER
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.writers.rasters import lacks
from jaxleas.types import InputError

TOPIC = "/grid_map"
FRAME = "map"
_INFO_TYPE = "grid_map_msgs/msg/GridMapInfo"
_HEADER = "std_msgs/Header header\n"
_VERSION = 9  # of ROS 2 bags: with the definitions of their messages


def write_bag(path: Path, height_map: HeightMap) -> str:
    """Write a bag of ROS 1 with one GridMap; return its topic and layer."""
    with _library(path):
        from rosbags.rosbag1 import Writer

    store = _store(1)
    with _beside(path) as folder:
        made = folder / "map.bag"
        with Writer(made) as writer:
            connection = writer.add_connection(TOPIC, TYPE, typestore=store)
            writer.write(connection, 0, store.serialize_ros1(_message(store, height_map, 1), TYPE))
        _put(made, path)
    return _SAID


def write_mcap(path: Path, height_map: HeightMap) -> str:
    """Write an MCAP file with one GridMap of ROS 2; return its topic and layer."""
    with _beside(path) as folder:
        made = folder / "bag"
        _write_ros2(path, made, height_map, "MCAP")
        _put(next(made.glob("*.mcap")), path)
    return _SAID


def write_folder(path: Path, height_map: HeightMap) -> str:
    """Write the folder of a ROS 2 bag with one GridMap; return its topic and layer.

    Raises:
        InputError: there is something of that name.
    """
    if path.exists():
        raise InputError(f"{path} exists: a ROS 2 bag is a folder of its own; give another name")
    with _beside(path) as folder:
        made = folder / path.name
        _write_ros2(path, made, height_map, "SQLITE3")
        made.rename(path)
    return f"the folder of a ROS 2 bag, {_SAID}"


_SAID = f"a GridMap on the topic {TOPIC}, layer {USUAL_LAYER}"


def _write_ros2(path: Path, made: Path, height_map: HeightMap, storage: str) -> None:
    with _library(path):
        from rosbags.rosbag2 import StoragePlugin, Writer

    store = _store(2)
    with Writer(made, version=_VERSION, storage_plugin=StoragePlugin[storage]) as writer:
        connection = writer.add_connection(TOPIC, TYPE, typestore=store)
        writer.write(connection, 0, store.serialize_cdr(_message(store, height_map, 2), TYPE))


def _store(version: int) -> Any:
    """Return the types of messages; in ROS 1 the header belongs to the info."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    texts = (INFO, GRID_MAP)
    if version == 1:
        texts = (_HEADER + INFO, GRID_MAP.removeprefix(_HEADER))
    store.register(get_types_from_msg(texts[0], _INFO_TYPE))
    store.register(get_types_from_msg(texts[1], TYPE))
    return store


def _message(store: Any, height_map: HeightMap, version: int) -> Any:
    """Return the map as a message: row 0 lies at the largest x, column 0 at the largest y."""

    def make(name: str, **values: Any) -> Any:
        return store.types[name.replace("/", "/msg/")](**values)

    x_min, x_max, y_min, y_max = height_map.extent
    stamp = make("builtin_interfaces/Time", sec=0, nanosec=0)
    sequence = {"seq": 0} if version == 1 else {}
    header = make("std_msgs/Header", stamp=stamp, frame_id=FRAME, **sequence)
    pose = make(
        "geometry_msgs/Pose",
        position=make(
            "geometry_msgs/Point", x=0.5 * (x_min + x_max), y=0.5 * (y_min + y_max), z=0.0
        ),
        orientation=make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
    )
    info = store.types[_INFO_TYPE](
        resolution=height_map.resolution,
        length_x=x_max - x_min,
        length_y=y_max - y_min,
        pose=pose,
        **({"header": header} if version == 1 else {}),
    )
    matrix = height_map.heights.T[::-1, ::-1]  # [along -x, along -y]
    dims = [
        make("std_msgs/MultiArrayDimension", label=label, size=size, stride=stride)
        for label, size, stride in (
            ("column_index", matrix.shape[1], matrix.size),
            ("row_index", matrix.shape[0], matrix.shape[0]),
        )
    ]
    data = make(
        "std_msgs/Float32MultiArray",
        layout=make("std_msgs/MultiArrayLayout", dim=dims, data_offset=0),
        data=np.ascontiguousarray(matrix.T, np.float32).reshape(-1),
    )
    return store.types[TYPE](
        info=info,
        layers=[USUAL_LAYER],
        basic_layers=[USUAL_LAYER],
        data=[data],
        outer_start_index=0,
        inner_start_index=0,
        **({"header": header} if version == 2 else {}),
    )


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """Yield a temporary folder beside a file: what is moved from there to its name is whole.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".") as folder:
            yield Path(folder)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from error


def _put(made: Path, path: Path) -> None:
    with atomic_path(path) as temporary:
        shutil.copyfile(made, temporary)


@contextmanager
def _library(path: Path) -> Iterator[None]:
    try:
        yield
    except ImportError as error:
        raise lacks("rosbags", path) from error
