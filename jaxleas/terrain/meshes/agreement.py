"""One file, one truth: a mesh's scene and its height map must show the same ground."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.areas import bounds
from jaxleas.terrain.rasterise import DEFAULT_RESOLUTION, rasterise_polygons
from jaxleas.terrain.scene import Scene
from jaxleas.types import InputError, is_ground

ALLOWED = 0.02
"""Fraction of the ground that may differ: faces that are left out are smaller than a foot."""
SAME = 0.03
"""Difference of heights that counts as none [m]."""
_CELLS_ACROSS = 500  # fine enough for a comparison, whatever the size
_GROW = 1e-3  # seams between neighbours in real meshes [m]


@dataclass(frozen=True)
class Agreement:
    """How a mesh's scene agrees with its height map.

    The map takes the highest face over each point; the scene takes faces that look up. They
    differ where the highest face looks down: a ceiling, or a face wound the wrong way round.

    Attributes:
        differing: fraction of the ground that the scene lacks, or shows lower.
        place: x and y of such a place [m].
        mean_gap: mean height of the map above the scene, of which 3 cm count at most [m].
        largest_gap: the largest such height [m].
    """

    differing: float
    place: tuple[float, float]
    mean_gap: float
    largest_gap: float


def compare(
    points: Float[np.ndarray, "P 3"], left_out: Sequence[Float[np.ndarray, "V 3"]], scene: Scene
) -> Agreement:
    """Return how a scene agrees with the height map of the mesh that it is made of.

    Args:
        points: vertices of the mesh [m].
        left_out: faces of the mesh that the scene lacks, as convex polygons [m].
        scene: scene made of the other faces.
    """
    low, high = bounds(points)
    across = (high - low)[:2].max()
    resolution = min(max(DEFAULT_RESOLUTION, float(across) / _CELLS_ACROSS), 0.5)
    # Triangles without area or sides keep both maps in one frame.
    frame = [np.tile(corner, (3, 1)) for corner in (low, high)]
    seen = _heights([*scene.surfaces.values(), *scene.obstacles.values(), *frame], resolution)
    ground = np.fmax(seen, _heights([*left_out, *frame], resolution))  # a NaN is no ground
    some = is_ground(ground)
    gap = np.where(is_ground(seen), np.clip(ground - seen, 0.0, SAME), SAME)[some]
    differs = some & ~(ground - seen < SAME)
    places = np.argwhere(differs)
    row, column = places[len(places) // 2] if len(places) else (0, 0)
    x, y = (np.floor(low[:2] / resolution) + 0.5 + [column, row]) * resolution
    count = max(int(some.sum()), 1)
    mean, largest = float(gap.sum()) / count, float(gap.max(initial=0.0))
    return Agreement(differs.sum() / count, (float(x), float(y)), mean, largest)


def require_agreement(path: str | Path, found: Agreement) -> None:
    """Refuse a mesh whose height map shows ground that its scene lacks.

    Args:
        path: path of the mesh, for the message.
        found: how its scene agrees with its height map.

    Raises:
        InputError: they differ on more than 2 % of the ground.
    """
    if found.differing > ALLOWED:
        x, y = found.place
        raise InputError(
            f"{path}: on {100.0 * found.differing:.0f} % of its ground, such as at {x:.2f},{y:.2f},"
            " the highest face looks down: a height map would show ground that a scene lacks; cut"
            " off a roof or ceiling, or turn the normals of that face"
        )


def _heights(polygons: Sequence[np.ndarray], resolution: float) -> Float[np.ndarray, "R C"]:
    return rasterise_polygons(polygons, resolution, 0.0, _GROW).heights
