"""Rotations, boxes, polytopes, and whether polygons meet them."""

from jaxleas.geometry.boxes import Box
from jaxleas.geometry.intersections import pack_polygons, polygons_meet_polytope
from jaxleas.geometry.polytopes import Polytope
from jaxleas.geometry.rotations import rotate_by_yaw, rotate_to_root, rotate_to_world, wrap_angle

__all__ = [
    "Box",
    "Polytope",
    "pack_polygons",
    "polygons_meet_polytope",
    "rotate_by_yaw",
    "rotate_to_root",
    "rotate_to_world",
    "wrap_angle",
]
