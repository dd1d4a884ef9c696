"""Meshes as triangles, z up and in metres; meshes that are not terrains are refused."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.mesh_files import read_mesh
from jaxleas.terrain.reading import Up
from jaxleas.types.errors import InputError

SUFFIXES = (".stl", ".obj")
MIN_EXTENT, MAX_EXTENT = 0.5, 1000.0
"""Accepted horizontal sizes of a terrain [m]."""
AXES: dict[str, tuple[int, int, int]] = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""Mesh axes that become x, y and z (a rotation), for each axis that may point up."""


def read_triangles(
    path: str | Path, up: Up = "z", scale: float = 1.0
) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of a mesh file, z up, in metres; degenerate ones are left out.

    Args:
        path: path of an STL (binary or text) or OBJ file.
        up: axis of the mesh that points up.
        scale: metres per unit of the file, 0.001 for millimetres.

    Raises:
        InputError: the file cannot be read, or is not a terrain.
    """
    if up not in AXES:
        raise InputError(f"up is '{up}'; it must be one of x, y, z")
    if not 0.0 < scale < np.inf:
        raise InputError(f"scale {scale:g} must be a positive number of metres per unit")
    if Path(path).suffix.lower() not in SUFFIXES:
        raise InputError(f"{path} is not a mesh this package reads: {', '.join(SUFFIXES)}")
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        triangles = read_mesh(Path(path))[..., AXES[up]] * scale
    if not len(triangles):
        raise InputError(f"{path} has no triangles: is it a mesh with faces?")
    if not np.isfinite(triangles).all():
        raise InputError(f"{path} has a vertex that is not a finite number")
    return _terrain_only(path, triangles)


def _terrain_only(
    path: str | Path, triangles: Float[np.ndarray, "N 3 3"]
) -> Float[np.ndarray, "N 3 3"]:
    spans = np.ptp(triangles.reshape(-1, 3)[:, :2], axis=0)
    if spans.max() < MIN_EXTENT or spans.max() > MAX_EXTENT:
        raise InputError(
            f"{path} spans {spans[0]:.4g} x {spans[1]:.4g} m; a terrain is {MIN_EXTENT:g} to "
            f"{MAX_EXTENT:g} m wide; are its units metres (see scale)?"
        )
    edges = triangles[:, 1:] - triangles[:, :1]
    area = 0.5 * np.cross(edges[:, 0], edges[:, 1])
    size = np.linalg.norm(area, axis=1)
    proper = size > 1e-12
    if not proper.any():
        raise InputError(f"{path} is degenerate: every triangle has zero area")
    if not (np.abs(area[proper, 2]) > 1e-3 * size[proper]).any():
        raise InputError(f"{path} is not a terrain: it has only vertical faces; is up right?")
    return triangles[proper]
