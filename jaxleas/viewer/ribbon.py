"""Paths as ribbons, and the trail of a walking robot, drawn piece by piece."""

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from jaxleas.viewer.ground import Colour
from jaxleas.viewer.painted import add_painted, two_sided
from jaxleas.viewer.terrain_mesh import Mesh

if TYPE_CHECKING:
    from viser import ViserServer

WIDTH = 0.022  # width of a ribbon [m]
PIECE = 48
"""Number of configurations of a piece of trail: only the last piece is drawn again as it grows."""
MOST_PIECES = 64
"""Maximum number of pieces of a trail; the oldest ones are removed first."""


def mesh_of_path(positions: Float[np.ndarray, "T 3"]) -> Mesh:
    """Return a path as a level and an upright strip along it, visible from every side.

    Args:
        positions: positions, at least two; some may coincide [m].
    """
    ahead = np.gradient(positions[:, :2], axis=0)
    length = np.linalg.norm(ahead, axis=1)
    moving = np.flatnonzero(length > 1e-9)
    if len(moving):  # a robot at rest keeps its direction; before it moves, its first one
        nearest = moving[np.maximum(np.searchsorted(moving, np.arange(len(ahead)), "right") - 1, 0)]
        ahead = ahead[nearest] / length[nearest, None]
    side = np.column_stack([-ahead[:, 1], ahead[:, 0], np.zeros(len(ahead))])
    up = np.broadcast_to([0.0, 0.0, 1.0], side.shape)
    strips = [positions + 0.5 * WIDTH * way for way in (side, -side, up, -up)]
    first = np.arange(len(positions) - 1)[:, None]
    quad = np.array([0, len(positions), len(positions) + 1, 0, len(positions) + 1, 1])
    faces = np.concatenate([first + quad, first + quad + 2 * len(positions)])
    return Mesh(np.concatenate(strips), faces.reshape(-1, 3))


def draw_path(
    server: "ViserServer", name: str, positions: Float[np.ndarray, "T 3"], colour: Colour
) -> None:
    """Draw a path [m], replacing one of the same name; one configuration makes no path."""
    if len(positions) < 2:
        server.scene.remove_by_name(name)
        return
    mesh = two_sided(mesh_of_path(np.asarray(positions, np.float64)))
    colours = np.tile(np.array(colour, np.float64), (len(mesh.vertices), 1))
    add_painted(server, name, mesh, colours)


class Trail:
    """The trail of a robot."""

    def __init__(self, server: "ViserServer", name: str, colour: Colour) -> None:
        """Begin an empty trail.

        Args:
            server: server of the page.
            name: name of the trail's node.
            colour: colour of the ribbon.
        """
        self._server, self._name, self._colour = server, name, colour
        self._pieces = 0
        self._positions: list[np.ndarray] = []

    def begin(self, position: Float[np.ndarray, " 3"]) -> None:
        """Restart the trail at a position [m]."""
        self._server.scene.remove_by_name(self._name)
        self._pieces, self._positions = 0, [position]

    def add(self, position: Float[np.ndarray, " 3"]) -> None:
        """Add a position [m], which the next `draw` shows."""
        self._positions.append(position)
        if len(self._positions) > PIECE:
            self.draw()
            self._pieces, self._positions = self._pieces + 1, [position]
            self._server.scene.remove_by_name(f"{self._name}/{self._pieces - MOST_PIECES}")

    def draw(self) -> None:
        """Draw the current state of the last piece."""
        if len(self._positions) > 1:
            name = f"{self._name}/{self._pieces}"
            draw_path(self._server, name, np.array(self._positions), self._colour)
