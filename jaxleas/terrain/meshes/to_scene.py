"""Meshes to scenes: faces that look up or sideways, as surfaces and obstacles."""

import logging
from dataclasses import replace
from itertools import compress
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.areas import area_vectors, area_vectors_of
from jaxleas.terrain.cropping import cropped_scene
from jaxleas.terrain.meshes.agreement import compare, require_agreement
from jaxleas.terrain.meshes.bodies import orient
from jaxleas.terrain.meshes.coplanar import merged
from jaxleas.terrain.meshes.mesh_edges import welded
from jaxleas.terrain.meshes.triangles import read_triangles
from jaxleas.terrain.places import require_near, shift_of
from jaxleas.terrain.polygons import MIN_AREA, STANDING_SLOPE, VERTICAL_SLOPE
from jaxleas.terrain.reading import READING, Reading, Up
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.scene_file import read_scene
from jaxleas.terrain.shaping import require_rectangle
from jaxleas.types import InputError

_LOG = logging.getLogger("jaxleas")
MAX_POLYGONS = 500_000
"""Largest number of polygons of a mesh's scene: about as many as fit in a file that is read."""
SEEN_WHOLE = 1e-3
"""Height of the map above the scene up to which no face can be wound the wrong way round [m]."""


def mesh_to_scene(
    path: str | Path,
    up: Up | None = None,
    scale: float | None = None,
    reading: Reading = READING,
) -> Scene:
    """Return a mesh as a scene of convex polygons; faces that point down are left out.

    Closed bodies are wound outwards if the scene lacks ground otherwise. Neighbours whose union is
    planar and convex are merged greedily into one polygon; the others stay triangles.

    Args:
        path: path of a mesh.
        up: axis of the mesh that points up; None: that of `reading`.
        scale: metres per unit of the file; None: that of `reading`.
        reading: what the file does not state itself, and what is done with it.

    Raises:
        InputError: the file is unreadable, is not a terrain, has no face to stand on, or its
            scene and its height map contradict each other.
    """
    stated = {"up": up, "scale": scale}
    reading = replace(reading, **{name: each for name, each in stated.items() if each is not None})
    points, faces = welded(read_triangles(path, reading))
    scene, left_out = _scene(points, faces, str(path))
    found = compare(points, left_out, scene)
    oriented = orient(points, faces) if found.largest_gap > SEEN_WHOLE else None
    if oriented is not None and oriented.turned:
        turned, left_out = _scene(points, oriented.faces, str(path))
        after = compare(points, left_out, turned)
        if after.mean_gap < found.mean_gap:  # bodies that pierce each other can mislead
            scene, found = turned, after
            _LOG.warning(
                "%s: %d faces of %d bodies were wound inside out and are turned",
                *(path, oriented.turned, oriented.bodies),
            )
    if not scene.surfaces:
        raise InputError(f"{path} has no face that looks up: are its triangles wound inside out?")
    require_agreement(path, found)
    return scene if reading.crop is None else cropped_scene(scene, reading.crop, str(path))


def _scene(
    points: Float[np.ndarray, "P 3"], faces: Int[np.ndarray, "N 3"], where: str
) -> tuple[Scene, list[Float[np.ndarray, "V 3"]]]:
    """Return the faces that look up or sideways, merged: surfaces to stand on, and obstacles.

    Returns:
        The scene; and the faces that it lacks, merged as well.
    """
    found = merged(points, faces)
    area = np.concatenate([area_vectors_of(found.polygons), area_vectors(found.triangles)])
    size = np.linalg.norm(area, axis=1)
    upward = area[:, 2] / np.maximum(size, 1e-12)
    kept = (size >= MIN_AREA) & (upward >= -VERTICAL_SLOPE)
    if kept.sum() > MAX_POLYGONS:
        raise InputError(
            f"{where} makes {kept.sum()} polygons, more than the {MAX_POLYGONS} of a scene: import"
            " it as a height map, in which surfaces are found; or give --crop, or decimate it"
        )
    surfaces, obstacles = {}, {}
    polygons = [*found.polygons, *found.triangles]
    for vertices, slope in zip(compress(polygons, kept), upward[kept].tolist(), strict=True):
        if slope >= STANDING_SLOPE:
            surfaces[f"surface_{len(surfaces)}"] = vertices
        else:
            obstacles[f"obstacle_{len(obstacles)}"] = vertices
    return Scene(surfaces, obstacles), list(compress(polygons, ~kept))


def read_placed_scene(path: str | Path, reading: Reading) -> Scene:
    """Return the scene of a .json file, moved and cropped as `reading` says."""
    scene = read_scene(path)
    corners = np.concatenate(scene.polygons)
    low = corners.min(axis=0)
    shift = shift_of(path, reading.origin, (float(low[0]), float(low[1])))
    if shift.any():
        scene = Scene(
            {name: each - shift for name, each in scene.surfaces.items()},
            {name: each - shift for name, each in scene.obstacles.items()},
            {name: each - shift[: each.shape[1]] for name, each in scene.areas.items()},
            scene.touch,
        )
    require_near(path, corners - shift)
    if reading.crop is None:
        return scene
    return cropped_scene(scene, require_rectangle(reading.crop), str(path))
