"""Terrains as binary STL: closed bodies, for simulators and for programs that edit meshes."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.files import write_bytes
from jaxleas.terrain.areas import area_vectors
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.loading import load_scene
from jaxleas.terrain.meshes.bodies import orient
from jaxleas.terrain.meshes.files import MAX_TRIANGLES
from jaxleas.terrain.meshes.formats import MESHES
from jaxleas.terrain.meshes.mesh_edges import is_closed, welded
from jaxleas.terrain.meshes.triangles import read_triangles
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.writers.map_body import map_body
from jaxleas.terrain.writers.scene_bodies import prisms_of
from jaxleas.types import InputError

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write_stl(path: str | Path, triangles: Float[np.ndarray, "N 3 3"]) -> None:
    """Write triangles as binary STL, whole or not at all; their units are metres, z points up.

    Args:
        path: path of the file.
        triangles: corners, counter-clockwise seen from outside [m].

    Raises:
        InputError: there are more triangles than this package reads, or the file cannot be written.
    """
    if len(triangles) > MAX_TRIANGLES:
        raise InputError(
            f"{path} would have {len(triangles)} triangles, more than {MAX_TRIANGLES}: give --crop,"
            " or a coarser --resolution"
        )
    area = area_vectors(triangles)
    records = np.zeros(len(triangles), _RECORD)
    records["normal"] = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-30)
    records["corners"] = triangles
    head = b"terrain in metres, z up".ljust(80) + np.uint32(len(triangles)).tobytes()
    write_bytes(path, head + records.tobytes())


def write_polygons_stl(path: Path, file: Path, reading: Reading) -> str:
    """Write a scene or mesh as closed bodies; return what they are.

    Closed bodies of a mesh stay as they are, wound outwards. Otherwise each polygon gets one.
    """
    if file.suffix.lower() in MESHES:
        points, faces = welded(read_triangles(file, reading))
        faces = orient(points, faces).faces
        if is_closed(faces):
            write_stl(path, points[faces])
            return f"its closed bodies as they are, {len(faces)} triangles"
    bodies = prisms_of(load_scene(file, reading))
    write_stl(path, np.concatenate([each.triangles for each in bodies.values()]))
    return f"{len(bodies)} closed convex bodies, one behind each polygon"


def write_map_stl(path: Path, height_map: HeightMap) -> str:
    """Write a height map as one closed body; return what it is."""
    triangles = map_body(height_map, path)
    write_stl(path, triangles)
    return f"one closed body of {len(triangles)} triangles through the middles of the cells"
