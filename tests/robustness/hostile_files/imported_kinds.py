"""Terrains in formats of others: some of our own readers, some of libraries in another process."""

import io
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tests.robustness.hostile_files import binary_mutations as b
from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.kinds import Kind, kind_of

POINTS = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0.2], [0, 1, 0.2], [1, 2, 0.1]], np.float32)
FACES = ((0, 1, 2, 3), (3, 2, 4))
MODEL = """<mujoco><compiler angle="degree"/><asset>
<hfield name="h" nrow="2" ncol="3" size="1 1 0.2 0.1" elevation="0 0 1 0 1 1"/></asset>
<default><geom friction="1"/></default><worldbody><geom type="plane" size="2 2 .1"/>
<body pos="1 0 0" euler="0 0 30"><geom type="box" size=".5 .5 .1"/></body>
<geom type="hfield" hfield="h" pos="3 0 0"/><body><freejoint/><geom type="sphere" size="1"/></body>
</worldbody></mujoco>
"""
GRID = """ncols 4
nrows 3
xllcorner 10
yllcorner 20
cellsize 0.25
NODATA_value -9999
0 0.5 1 1
0.25 -9999 2 1
0 0 0 1
"""
BOXES = """stones:
  - [[0, 0, 0], [0, 0, 1], [2.0, 2.5, 0.2], [0]]
  - {top: [1.5, 0, 0.1], size: [0.4, 0.4, 0.3], normal: [0.1, 0, 1], yaw: 0.2}
"""


def imported_kinds(folder: Path) -> list[Kind]:
    """Return kinds of files that other programs write."""
    from jaxleas.terrain import import_terrain

    coarse = partial(import_terrain, resolution=0.5)
    grey = partial(import_terrain, resolution=0.1, z_min=0.0, z_max=1.0)
    table = partial(import_terrain, resolution=0.1)
    kinds = [("text PLY", "text.ply", _text_ply(), coarse, m.mutate_text)]
    kinds += [("binary PLY", "binary.ply", binary_ply("<"), coarse, m.mutate_bytes)]
    kinds += [("OFF", "mesh.off", _off(), coarse, m.mutate_text)]
    kinds += [("boxes", "boxes.yaml", BOXES.encode(), coarse, m.mutate_text)]
    kinds += [("npy", "heights.npy", _npy(), table, m.mutate_bytes)]
    kinds += [("CSV", "heights.csv", b"0,0.5,1\n0.25,,2\n0,0,0\n", table, m.mutate_text)]
    kinds += [("ASCII grid", "heights.asc", GRID.encode(), import_terrain, m.mutate_text)]
    kinds += [("points", "points.csv", _points(), import_terrain, m.mutate_text)]
    kinds += [("colour PNG", "colour.png", _png("RGBA"), grey, b.mutate_png)]
    kinds += [("palette PNG", "palette.png", _png("P"), grey, b.mutate_png)]
    kinds += [("GLB", "mesh.glb", _glb(), coarse, m.mutate_bytes)]
    kinds += [("TIFF", "heights.tif", _tiff(), import_terrain, m.mutate_bytes)]
    kinds += [("MJCF", "model.xml", MODEL.encode(), coarse, m.mutate_text)]
    kinds += [("ROS 1 bag", "map.bag", _bag(folder), import_terrain, m.mutate_bytes)]
    kinds += [("MCAP", "map.mcap", _mcap(folder), import_terrain, m.mutate_bytes)]
    found = []
    for name, file, content, read, mutate in kinds:
        (folder / file).write_bytes(content)
        found.append(kind_of(name, folder / file, read, mutate))
    return found


def _text_ply() -> bytes:
    head = [
        *("ply", "format ascii 1.0", f"element vertex {len(POINTS)}"),
        *(f"property float {axis}" for axis in "xyz"),
        *(f"element face {len(FACES)}", "property list uchar int vertex_indices", "end_header"),
    ]
    rows = [" ".join(map(str, point)) for point in POINTS.tolist()]
    rows += [" ".join(map(str, (len(face), *face))) for face in FACES]
    return "\n".join([*head, *rows, ""]).encode()


def binary_ply(order: str) -> bytes:
    """Return a binary PLY in a byte order, "<" or ">"."""
    head = _text_ply().partition(b"end_header\n")
    faces = b"".join(bytes([len(f)]) + np.array(f, f"{order}i4").tobytes() for f in FACES)
    name = b"binary_little_endian" if order == "<" else b"binary_big_endian"
    layout = head[0].replace(b"ascii", name)
    return layout + head[1] + POINTS.astype(f"{order}f4").tobytes() + faces


def _off() -> bytes:
    rows = [" ".join(map(str, point)) for point in POINTS.tolist()]
    rows += [" ".join(map(str, (len(face), *face))) for face in FACES]
    return "\n".join(["OFF", f"{len(POINTS)} {len(FACES)} 0", *rows, ""]).encode()


def _npy() -> bytes:
    out = io.BytesIO()
    np.save(out, np.arange(12, dtype=np.int16).reshape(3, 4))
    return out.getvalue()


def _points() -> bytes:
    rows = [f"{0.1 * x:.1f},{0.1 * y:.1f},{0.05 * x}" for x in range(4) for y in range(3)]
    return "\n".join(["x,y,z", *rows, ""]).encode()


def _png(mode: str) -> bytes:
    values = np.random.default_rng(0).integers(0, 256, (9, 12, 4)).astype(np.uint8)
    values[..., 3] |= 128
    out = io.BytesIO()
    Image.fromarray(values).convert(mode).save(out, "PNG")
    return out.getvalue()


def _glb() -> bytes:
    import trimesh

    faces = [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    content: Any = trimesh.Trimesh(POINTS, faces, process=False).export(file_type="glb")
    return content


def _tiff() -> bytes:
    import tifffile

    out = io.BytesIO()
    place = [(33550, "d", 3, (0.1, 0.1, 0.0)), (33922, "d", 6, (0, 0, 0, 5.0, 5.0, 0))]
    heights = np.arange(48, dtype=np.float32).reshape(6, 8)
    tifffile.imwrite(out, heights, compression="deflate", extratags=place)
    return out.getvalue()


def _bag(folder: Path) -> bytes:
    from rosbags.rosbag1 import Writer

    path, store = folder / "made.bag", message_store(1)
    with Writer(path) as writer:
        connection = writer.add_connection("/map", GRID_MAP, typestore=store)
        writer.write(connection, 1, store.serialize_ros1(grid_map(store, 1), GRID_MAP))
    return path.read_bytes()


def _mcap(folder: Path) -> bytes:
    from rosbags.rosbag2 import StoragePlugin, Writer

    path, store = folder / "made", message_store(2)
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/map", GRID_MAP, typestore=store)
        writer.write(connection, 1, store.serialize_cdr(grid_map(store, 2), GRID_MAP))
    return next(path.glob("*.mcap")).read_bytes()


GRID_MAP = "grid_map_msgs/msg/GridMap"


def message_store(version: int) -> Any:
    """Return the message types of a version of ROS, GridMap among them."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    header = "std_msgs/Header header\n"
    info = "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n"
    body = (
        "grid_map_msgs/GridMapInfo info\nstring[] layers\nstring[] basic_layers\n"
        "std_msgs/Float32MultiArray[] data\nuint16 outer_start_index\nuint16 inner_start_index\n"
    )
    store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    texts = (header + info, body) if version == 1 else (info, header + body)
    store.register(get_types_from_msg(texts[0], "grid_map_msgs/msg/GridMapInfo"))
    store.register(get_types_from_msg(texts[1], GRID_MAP))
    return store


def grid_map(store: Any, version: int) -> Any:
    """Return a message of 3 x 4 cells whose buffer was moved round."""

    def make(name: str, **values: Any) -> Any:
        return store.types[name.replace("/", "/msg/")](**values)

    seq = {"seq": 0} if version == 1 else {}
    stamp = make("builtin_interfaces/Time", sec=1, nanosec=2)
    header = {"header": make("std_msgs/Header", stamp=stamp, frame_id="map", **seq)}
    pose = make(
        "geometry_msgs/Pose",
        position=make("geometry_msgs/Point", x=0.0, y=0.0, z=0.0),
        orientation=make("geometry_msgs/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0),
    )
    sizes = {"resolution": 0.1, "length_x": 0.3, "length_y": 0.4, "pose": pose}
    info = make("grid_map_msgs/GridMapInfo", **sizes, **(header if version == 1 else {}))
    dims = [
        make("std_msgs/MultiArrayDimension", label=label, size=size, stride=12)
        for label, size in (("column_index", 4), ("row_index", 3))
    ]
    layout = make("std_msgs/MultiArrayLayout", dim=dims, data_offset=0)
    data = make("std_msgs/Float32MultiArray", layout=layout, data=np.zeros(12, np.float32))
    return store.types[GRID_MAP](
        info=info,
        layers=["elevation"],
        basic_layers=[],
        data=[data],
        outer_start_index=1,
        inner_start_index=2,
        **({} if version == 1 else header),
    )
