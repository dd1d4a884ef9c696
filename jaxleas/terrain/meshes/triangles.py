"""Meshes as triangles, z up and in metres; meshes that are not terrains are refused."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.areas import area_vectors, bounds
from jaxleas.terrain.meshes.files import Triangles
from jaxleas.terrain.meshes.formats import MESHES
from jaxleas.terrain.places import require_near, shift_of
from jaxleas.terrain.reading import READING, Reading, Rectangle, Up, require_applicable
from jaxleas.terrain.shaping import require_rectangle
from jaxleas.types import InputError

SUFFIXES = tuple(MESHES)
MIN_EXTENT, MAX_EXTENT = 0.5, 1000.0
"""Accepted horizontal sizes of a terrain [m]."""
COARSEST = 0.01
"""Distance between neighbouring 32-bit numbers above which a mesh has lost its shape [m]."""
AXES: dict[str, tuple[int, int, int]] = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
"""Mesh axes that become x, y and z (a rotation), for each axis that may point up."""


def read_triangles(path: str | Path, reading: Reading = READING) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of a mesh file, z up, in metres; degenerate ones are left out.

    Args:
        path: path of a mesh, of one of the `SUFFIXES`.
        reading: its axis that points up, its scale, what becomes the origin, and what is kept.

    Raises:
        InputError: the file cannot be read, or is not a terrain.
    """
    form = MESHES.get(Path(path).suffix.lower())
    if form is None:
        raise InputError(f"{path} is not a mesh this package reads: {', '.join(SUFFIXES)}")
    require_applicable(path, reading, form.options, form.title)
    up, scale = reading.up, reading.scale
    if up is not None and up not in AXES:
        raise InputError(f"up is '{up}'; it must be one of x, y, z")
    if not 0.0 < scale < np.inf:
        raise InputError(f"scale {scale:g} must be a positive number of metres per unit")
    found = form.read(Path(path))
    with np.errstate(over="ignore", invalid="ignore"):  # refused below
        triangles = _upright(found, up or found.up)
        if scale != 1.0:
            triangles = triangles * scale
    if not len(triangles):
        raise InputError(f"{path} has no triangles: is it a mesh with faces?")
    if not np.isfinite(triangles).all():
        raise InputError(f"{path} has a vertex that is not a finite number")
    _require_fine(path, found, scale)
    low, _ = bounds(triangles)
    shift = shift_of(path, reading.origin, (float(low[0]), float(low[1])))
    if shift.any():
        triangles = triangles - shift
    if reading.crop is not None:
        triangles = _near(path, triangles, require_rectangle(reading.crop))
    triangles = _terrain_only(path, triangles)
    require_near(path, np.array(bounds(triangles)))
    return triangles


def _upright(found: Triangles, up: Up) -> Float[np.ndarray, "N 3 3"]:
    if found.gltf and up == "y":
        return found.corners[..., (0, 2, 1)] * [1.0, -1.0, 1.0]
    return found.corners if up == "z" else found.corners[..., AXES[up]]


def _near(
    path: str | Path, triangles: Float[np.ndarray, "N 3 3"], crop: Rectangle
) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles that reach into a rectangle."""
    low, high = triangles[..., :2].min(axis=1), triangles[..., :2].max(axis=1)
    x_min, x_max, y_min, y_max = crop
    inside = (low <= [x_max, y_max]).all(axis=1) & (high >= [x_min, y_min]).all(axis=1)
    if not inside.any():
        (x, y), (x_end, y_end) = low.min(axis=0), high.max(axis=0)
        raise InputError(
            f"--crop leaves nothing of {path}, which spans x {x:.2f} to {x_end:.2f} m,"
            f" y {y:.2f} to {y_end:.2f} m"
        )
    return triangles[inside]


def _require_fine(path: str | Path, found: Triangles, scale: float) -> None:
    """Refuse 32-bit coordinates so far from the origin that steps of a terrain are lost."""
    farthest = np.abs(found.corners).max()
    apart = float(np.spacing(np.float32(farthest))) * scale
    if found.single and apart > COARSEST:
        raise InputError(
            f"{path} holds 32-bit numbers, which lie {apart:.2g} m apart at"
            f" {farthest * scale:.7g} m: its shape is lost; subtract the offset before the mesh is"
            " exported, or export text (.obj) and give --origin auto"
        )


def _terrain_only(
    path: str | Path, triangles: Float[np.ndarray, "N 3 3"]
) -> Float[np.ndarray, "N 3 3"]:
    low, high = bounds(triangles)
    spans = (high - low)[:2]
    if spans.max() < MIN_EXTENT or spans.max() > MAX_EXTENT:
        raise InputError(
            f"{path} spans {spans[0]:.4g} x {spans[1]:.4g} m; a terrain is {MIN_EXTENT:g} to "
            f"{MAX_EXTENT:g} m wide; are its units metres (see scale)?"
        )
    area = area_vectors(triangles)
    size = np.linalg.norm(area, axis=1)
    proper = size > 1e-12
    if not proper.any():
        raise InputError(f"{path} is degenerate: every triangle has zero area")
    if not (np.abs(area[proper, 2]) > 1e-3 * size[proper]).any():
        raise InputError(f"{path} is not a terrain: it has only vertical faces; is up right?")
    return triangles if proper.all() else triangles[proper]
