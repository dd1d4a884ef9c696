"""Rotations, boxes, polytopes, and the intersections of polygons with polytopes."""

from jaxleas.geometry.boxes import Box
from jaxleas.geometry.clipping import clip_polygon
from jaxleas.geometry.intersections import pack_polygons, polygons_meet_polytope
from jaxleas.geometry.polytopes import Polytope
from jaxleas.geometry.rotations import (
    rotate_by_yaw,
    rotate_to_root,
    rotate_to_world,
    squared_length,
    wrap_angle,
    wrap_angle_on_host,
)
from jaxleas.xla.angles import bearing, sine_cosine

__all__ = [
    "Box",
    "Polytope",
    "bearing",
    "clip_polygon",
    "pack_polygons",
    "polygons_meet_polytope",
    "rotate_by_yaw",
    "rotate_to_root",
    "rotate_to_world",
    "sine_cosine",
    "squared_length",
    "wrap_angle",
    "wrap_angle_on_host",
]
