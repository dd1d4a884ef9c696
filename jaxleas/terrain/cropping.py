"""The part of a scene in a rectangle."""

from typing import TYPE_CHECKING

import numpy as np

from jaxleas.terrain.polygons import MIN_AREA, polygon_area_vector
from jaxleas.terrain.reading import Rectangle
from jaxleas.terrain.scene import Polygons, Scene, Touch
from jaxleas.types import InputError

if TYPE_CHECKING:
    from jaxleas.geometry import Polytope


def cropped_scene(scene: Scene, crop: Rectangle, where: str) -> Scene:
    """Return the part of a scene whose x and y lie in a rectangle; areas stay as they are.

    Raises:
        InputError: no surface is left.
    """
    from jaxleas.geometry import Polytope  # here, as it loads SciPy

    x_min, x_max, y_min, y_max = crop
    sides = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]])
    inside = Polytope(sides, np.array([-x_min, x_max, -y_min, y_max]))
    surfaces, obstacles = (_cut(group, inside) for group in (scene.surfaces, scene.obstacles))
    if not surfaces:
        raise InputError(f"--crop leaves no surface of {where}")
    touch: dict[str, Touch] = {k: who for k, who in scene.touch.items() if k in surfaces}
    return Scene(surfaces, obstacles, scene.areas, touch)


def _cut(polygons: Polygons, inside: "Polytope") -> Polygons:
    from jaxleas.geometry import clip_polygon

    cut = {name: clip_polygon(vertices, inside) for name, vertices in polygons.items()}
    return {
        name: vertices
        for name, vertices in cut.items()
        if len(vertices) >= 3 and np.linalg.norm(polygon_area_vector(vertices)) >= MIN_AREA
    }
