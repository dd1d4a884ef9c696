"""What all tiles share: their kinds, their frame, and the polygons that fill one."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from jaxtyping import Float

Rectangle = tuple[float, float, float, float]
"""Rectangle s_min, s_max, t_min, t_max [m]."""


class TileKind(StrEnum):
    """Kinds of tiles; Flat and Obstacles are initial, the others transitions."""

    FLAT = "flat"
    OBSTACLES = "obstacles"
    RUBBLE = "rubble"
    BRIDGE = "bridge"
    STAIRS = "stairs"
    HOLE = "hole"
    WALL = "wall"
    LEDGE = "ledge"
    GAP = "gap"
    BARRIER = "barrier"
    POSTS = "posts"
    VOID = "void"

    @property
    def is_initial(self) -> bool:
        """Whether a robot may start and end here."""
        return self in (TileKind.FLAT, TileKind.OBSTACLES)


@dataclass(frozen=True)
class TileFrame:
    """The frame of a tile in the world.

    Attributes:
        entry: x, y of the middle of the entry edge [m].
        direction: unit vector from the entry to the exit edge, along an axis of the world.
        size: edge of the tile [m].
        inset: length by which rectangles are shrunk on each side [m].
    """

    entry: tuple[float, float]
    direction: tuple[float, float]
    size: float
    inset: float

    def to_world(self, points: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "V 2"]:
        """Return points (s, t) of the tile in the world [m]."""
        along = np.array(self.direction, dtype=np.float64)
        left = np.array([-along[1], along[0]])
        return np.array(self.entry) + points[:, :1] * along + points[:, 1:] * left

    def outline(self, rectangle: Rectangle) -> Float[np.ndarray, "4 2"]:
        """Return the corners of a rectangle of the tile in the world [m]."""
        return self.to_world(_corners(rectangle, 0.0))

    def rectangle(
        self, rectangle: Rectangle, middle: float, slope: tuple[float, float] = (0.0, 0.0)
    ) -> Float[np.ndarray, "4 3"]:
        """Return the corners of a contact surface over a rectangle of the tile, inset [m].

        Args:
            rectangle: rectangle before it is shrunk.
            middle: height of its centre [m].
            slope: its rise per metre along s and along t [1].
        """
        s_min, s_max, t_min, t_max = rectangle
        centre = np.array([0.5 * (s_min + s_max), 0.5 * (t_min + t_max)])
        corners = _corners(rectangle, self.inset)
        z = middle + (corners - centre) @ np.array(slope)
        return np.column_stack([self.to_world(corners), z])


@dataclass(frozen=True)
class TilePolygons:
    """The polygons of a tile, and its difficulty (see `links.Link.difficulty`)."""

    surfaces: list[Float[np.ndarray, "V 3"]] = field(default_factory=list)
    boxes: list[dict[str, Float[np.ndarray, "4 3"]]] = field(default_factory=list)
    difficulty: float = 0.0


def _corners(rectangle: Rectangle, inset: float) -> Float[np.ndarray, "4 2"]:
    s_min, s_max = rectangle[0] + inset, rectangle[1] - inset
    t_min, t_max = rectangle[2] + inset, rectangle[3] - inset
    return np.array([[s_min, t_min], [s_max, t_min], [s_max, t_max], [s_min, t_max]])
