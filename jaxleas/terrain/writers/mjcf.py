"""Terrains as MJCF models, which MuJoCo and MJX load: boxes, convex meshes, or a height field."""

from pathlib import Path
from xml.etree.ElementTree import Element, ElementTree, SubElement, indent

import numpy as np
from jaxtyping import Float

from jaxleas.files import atomic_path
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.loading import load_scene
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.writers.scene_bodies import THICKNESS, Prism, prisms_of
from jaxleas.types import is_ground

PIT = 1.0
"""Depth of cells without ground below the lowest ground: a height field has no holes [m]."""
_ALONG = 1e-6
"""Difference from the axes up to which a body is a box along them [m]."""


def write_polygons_mjcf(path: Path, file: Path, reading: Reading) -> str:
    """Write a scene or mesh as geoms that stand still, one behind each polygon; return what."""
    root = scene_mjcf(load_scene(file, reading), path.stem)
    _write(path, root)
    meshes = len(root.findall("asset/mesh"))
    boxes = len(root.findall("worldbody/geom")) - meshes
    return f"an MJCF model of {boxes} boxes and {meshes} convex meshes"


def scene_mjcf(scene: Scene, name: str = "scene") -> Element:
    """Return a scene as an MJCF model of geoms that stand still, one behind each polygon.

    Args:
        scene: scene whose surfaces and obstacles become boxes and convex meshes.
        name: name of the model.
    """
    root, assets, world = _model(name)
    for each, body in prisms_of(scene).items():
        box = _box(body)
        if box is not None:
            middle, half = box
            SubElement(world, "geom", name=each, type="box", pos=_text(middle), size=_text(half))
        else:
            corners = np.concatenate([body.top, body.bottom])
            SubElement(assets, "mesh", name=each, vertex=_text(corners))
            SubElement(world, "geom", name=each, type="mesh", mesh=each)
    return root


def write_map_mjcf(path: Path, height_map: HeightMap) -> str:
    """Write a height map as a height field through the middles of its cells; return what."""
    ground = is_ground(height_map.heights)
    low, high = float(np.nanmin(height_map.heights)), float(np.nanmax(height_map.heights))
    floor = low if ground.all() else low - PIT
    span = max(high - floor, _ALONG)
    levels = (np.where(ground, height_map.heights, floor) - floor) / span
    rows, columns = height_map.shape
    half = 0.5 * height_map.resolution * (np.array([columns, rows]) - 1)
    root, assets, world = _model(path.stem)
    field = SubElement(assets, "hfield", name="ground", nrow=str(rows), ncol=str(columns))
    field.set("size", _text([*half, span, THICKNESS]))
    field.set("elevation", _text(levels[::-1]))  # north first, unlike in a compiled model
    middle = [*(np.array(height_map.origin) + half), floor]
    SubElement(world, "geom", name="ground", type="hfield", hfield="ground", pos=_text(middle))
    _write(path, root)
    pits = "" if ground.all() else f"; cells without ground are {PIT:g} m deep"
    return f"an MJCF model of one height field{pits}"


def _model(name: str) -> tuple[Element, Element, Element]:
    """Return an empty model, the place of its assets and that of its geoms."""
    root = Element("mujoco", model=name)
    return root, SubElement(root, "asset"), SubElement(root, "worldbody")


def _box(body: Prism) -> tuple[np.ndarray, np.ndarray] | None:
    """Return middle and half sizes of a body that is a box along the axes [m]."""
    corners = np.concatenate([body.top, body.bottom])
    low, high = corners.min(axis=0), corners.max(axis=0)
    if len(corners) != 8 or (np.minimum(corners - low, high - corners) > _ALONG).any():
        return None
    return 0.5 * (low + high), 0.5 * (high - low)


def _text(numbers: Float[np.ndarray, "*N"] | list[float]) -> str:
    return " ".join(f"{each:.9g}" for each in np.reshape(numbers, -1))


def _write(path: Path, root: Element) -> None:
    indent(root)
    with atomic_path(path) as temporary:
        ElementTree(root).write(temporary, encoding="utf-8")
