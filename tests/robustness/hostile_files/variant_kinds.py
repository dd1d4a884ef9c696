"""Terrains as other writers choose to write them: byte orders, packings, further number types."""

import io
import struct
import zlib
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer

from tests.robustness.hostile_files import binary_mutations as b
from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.imported_kinds import (
    FACES,
    GRID_MAP,
    POINTS,
    binary_ply,
    grid_map,
    message_store,
)
from tests.robustness.hostile_files.kinds import Kind, kind_of

MESH_MODEL = """<mujoco><asset><mesh name="m" file="part.stl" scale="1 1 1"/></asset><worldbody>
<geom type="mesh" mesh="m"/><geom type="plane" size="2 2 .1"/></worldbody></mujoco>
"""


def variant_kinds(folder: Path) -> list[Kind]:
    """Return kinds of files that hold the same as others, packed in another way."""
    from jaxleas.terrain import import_terrain, load_scene

    coarse = partial(import_terrain, resolution=0.5)
    grey = partial(import_terrain, resolution=0.1, z_min=0.0, z_max=1.0)
    kinds = [("deep colour PNG", "deep.png", _deep_png(), grey, b.mutate_png)]
    kinds += [("interlaced PNG", "interlaced.png", _interlaced_png(), grey, b.mutate_png)]
    kinds += [("tiled TIFF", "tiled.tif", _tiled_tiff(), grey, m.mutate_bytes)]
    kinds += [("big-endian PLY", "big.ply", binary_ply(">"), coarse, m.mutate_bytes)]
    kinds += [("map of whole numbers", "whole.npz", _whole_npz(), import_terrain, b.mutate_npz)]
    kinds += [("map to surfaces", "sensor.npz", _sensor_npz(), load_scene, b.mutate_npz)]
    kinds += [("ROS 2 bag", "map.db3", _db3(folder), import_terrain, m.mutate_bytes)]
    kinds += [("packed MCAP", "packed.mcap", _packed_mcap(folder), import_terrain, m.mutate_bytes)]
    found = []
    for name, file, content, read, mutate in kinds:
        (folder / file).write_bytes(content)
        found.append(kind_of(name, folder / file, read, mutate))
    (folder / "part.stl").write_bytes(_stl())
    (folder / "with_mesh.xml").write_text(MESH_MODEL)
    mesh, model = folder / "part.stl", folder / "with_mesh.xml"
    found.append(kind_of("MJCF with a mesh", model, coarse, m.mutate_text, mesh))
    found.append(kind_of("mesh to scene", mesh, load_scene, b.mutate_stl))
    return found


def _chunked(header: tuple[int, ...], lines: bytes) -> bytes:
    """Return a PNG from the numbers of its header and its unpacked lines."""
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", *header)), (b"IDAT", zlib.compress(lines))]
    content = b"\x89PNG\r\n\x1a\n"
    for kind, body in [*chunks, (b"IEND", b"")]:
        tail = struct.pack(">I", zlib.crc32(kind + body))
        content += struct.pack(">I", len(body)) + kind + body + tail
    return content


def _deep_png() -> bytes:
    """Return 6 x 5 pixels of RGBA with 16 bits; each row has another filter."""
    rows = np.random.default_rng(0).integers(0, 256, (5, 6 * 8)).astype(np.uint8)
    lines = b"".join(bytes([kind]) + row.tobytes() for kind, row in enumerate(rows))
    return _chunked((6, 5, 16, 6, 0, 0, 0), lines)


def _interlaced_png() -> bytes:
    """Return 8 x 8 pixels of grey and alpha with 16 bits, in seven passes."""
    lines = b""
    sides = ((1, 1), (1, 1), (1, 2), (2, 2), (2, 4), (4, 4), (4, 8))  # rows and columns of a pass
    for rows, columns in sides:
        pixels = np.full((rows, columns, 2), (1000 * rows, 65535), ">u2")
        lines += b"".join(b"\0" + row.tobytes() for row in pixels)
    return _chunked((8, 8, 16, 4, 0, 0, 1), lines)


def _tiled_tiff() -> bytes:
    import tifffile

    out = io.BytesIO()
    levels = np.arange(20 * 24, dtype=np.uint16).reshape(20, 24)
    tifffile.imwrite(
        *(out, levels), byteorder=">", tile=(16, 16), compression="lzw", predictor=True
    )
    return out.getvalue()


def _whole_npz() -> bytes:
    out = io.BytesIO()
    heights = np.array([[0, 0, 1], [1, 1, 1], [2, 2, 2]], np.int16)
    np.savez_compressed(out, heights=heights, resolution=np.float64(0.5), origin=[1, 2])
    return out.getvalue()


def _sensor_npz() -> bytes:
    """Return a map of a floor and a step with noise and a hole."""
    heights = np.zeros((24, 24), np.float32)
    heights[:, 12:] = 0.15
    heights += np.random.default_rng(0).normal(0.0, 0.005, heights.shape).astype(np.float32)
    heights[3:8, 3:8] = np.nan
    out = io.BytesIO()
    np.savez(out, heights=heights, resolution=np.float64(0.04), origin=np.zeros(2))
    return out.getvalue()


def _stl() -> bytes:
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    triangles = np.zeros(2 * len(FACES), record)
    triangles["corners"] = POINTS[[[0, 1, 2], [0, 2, 3], [3, 2, 4], [3, 2, 4]]]
    return b"two squares".ljust(80) + np.uint32(len(triangles)).tobytes() + triangles.tobytes()


def _db3(folder: Path) -> bytes:
    return _ros_2(folder / "made_db3", "*.db3", {})


def _packed_mcap(folder: Path) -> bytes:
    """Return an MCAP file without an index whose chunk is packed by LZ4."""
    import lz4.frame

    plain = _ros_2(folder / "made_mcap", "*.mcap", {"storage_plugin": StoragePlugin.MCAP})
    records = _records(plain[8:-8])
    inner = b"".join(_record(kind, body) for kind, body in records if kind in _IN_CHUNKS)
    for kind, body in records:
        if kind == _CHUNK:  # times, size, checksum, name of the packing, size, records
            inner += body[32 + int.from_bytes(body[28:32], "little") + 8 :]
    packed = lz4.frame.compress(inner)
    sizes = struct.pack("<QQQI", 1, 1, len(inner), 0) + struct.pack("<I", 3) + b"lz4"
    chunk = sizes + len(packed).to_bytes(8, "little") + packed
    header = next(body for kind, body in records if kind == _HEADER)
    parts = [(_HEADER, header), (_CHUNK, chunk), (_END, bytes(4)), (_FOOTER, bytes(20))]
    return plain[:8] + b"".join(_record(kind, body) for kind, body in parts) + plain[:8]


_HEADER, _FOOTER, _CHUNK, _END = 1, 2, 6, 15
_IN_CHUNKS = (3, 4, 5)  # schemas, channels and messages
"""Kinds of records (mcap.dev/spec)."""


def _records(content: bytes) -> list[tuple[int, bytes]]:
    found, at = [], 0
    while at < len(content):
        size = int.from_bytes(content[at + 1 : at + 9], "little")
        found.append((content[at], content[at + 9 : at + 9 + size]))
        at += 9 + size
        if found[-1][0] == _END:  # what follows repeats it as an index
            return found
    return found


def _record(kind: int, body: bytes) -> bytes:
    return bytes([kind]) + len(body).to_bytes(8, "little") + body


def _ros_2(path: Path, pattern: str, options: dict[str, Any]) -> bytes:

    store = message_store(2)
    with Writer(path, version=9, **options) as writer:
        connection = writer.add_connection("/map", GRID_MAP, typestore=store)
        writer.write(connection, 1, store.serialize_cdr(grid_map(store, 2), GRID_MAP))
    return next(path.glob(pattern)).read_bytes()
