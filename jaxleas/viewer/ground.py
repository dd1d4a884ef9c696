"""The drawing of a terrain, and the first position of the camera.

Nothing here needs JAX: the ground is visible while the rest is still being loaded.
"""

from typing import TYPE_CHECKING

import numpy as np

from jaxleas.terrain import HeightMap, Scene
from jaxleas.types import is_ground
from jaxleas.viewer.painted import add_painted, shade
from jaxleas.viewer.terrain_mesh import Mesh, mesh_of_edges, mesh_of_map, mesh_of_polygons

if TYPE_CHECKING:
    from viser import ViserServer

Colour = tuple[int, int, int]

SKY_ABOVE, SKY_BELOW = (212, 223, 235), (240, 244, 247)
DEEP, TALL = np.array([84.0, 99.0, 118.0]), np.array([196.0, 178.0, 142.0])
"""Colours of the lowest and of the highest ground."""
OBSTACLE = np.array([168.0, 88.0, 70.0])
EDGE: Colour = (58, 64, 74)
EDGE_WIDTH = 0.012  # width of drawn edges [m]
LARGEST_VIEW = 9.0
"""Size above which the ground is not shown as a whole when robots are driven [m]."""

NEAR_ENOUGH = 1.0
"""Distance within which a camera that looks near its target is not moved [m]."""


def draw_terrain(server: "ViserServer", terrain: HeightMap, scene: Scene | None) -> None:
    """Draw a terrain, as a scene's polygons or as a height map, and look at it from the south.

    Args:
        server: server of the page.
        terrain: height map of the terrain.
        scene: scene whose surfaces and obstacles are drawn, if the terrain was a scene.
    """
    low, high = float(np.nanmin(terrain.heights)), float(np.nanmax(terrain.heights))
    server.scene.configure_default_lights(enabled=False)
    server.scene.configure_environment_map(None)
    if scene is None:
        _add_mesh(server, "/terrain", mesh_of_map(terrain), (low, high))
    else:
        _add_mesh(server, "/terrain", mesh_of_polygons(scene.surfaces.values()), (low, high))
        if scene.obstacles:
            obstacles = mesh_of_polygons(scene.obstacles.values())
            _add_mesh(server, "/obstacles", obstacles, (low, high), OBSTACLE)
        edges = mesh_of_edges(scene.polygons, EDGE_WIDTH)
        colours = np.tile(np.array(EDGE, np.float64), (len(edges.vertices), 1))
        add_painted(server, "/edges", edges, colours)
    look_at_all(server, terrain)


def paint_sky(server: "ViserServer") -> None:
    """Colour the background of the page.

    Viser draws its own background again in each frame: 16 of the 40 ms that a frame takes in
    software. A background in the page's style costs nothing.
    """
    sky = f"linear-gradient(rgb{SKY_ABOVE}, rgb{SKY_BELOW})"
    server.gui.add_html(f"<style>canvas[data-engine] {{ background: {sky} }}</style>")


def _add_mesh(
    server: "ViserServer",
    name: str,
    mesh: Mesh,
    heights: tuple[float, float],
    tallest: np.ndarray = TALL,
) -> None:
    """Add a mesh that is brighter where it is higher."""
    low, high = heights
    share = (mesh.vertices[:, 2:] - low) / max(high - low, 0.5)
    colours = DEEP + np.clip(share, 0.0, 1.0) * (tallest - DEEP)
    if tallest is not TALL:
        colours = 0.4 * colours + 0.6 * tallest
    add_painted(server, name, mesh, shade(mesh, colours))


def look_at_all(server: "ViserServer", terrain: HeightMap) -> None:
    """Place the camera so that the whole ground is in view."""
    rows, columns = np.nonzero(is_ground(terrain.heights))
    low = np.array([columns.min(), rows.min()]) * terrain.resolution + terrain.origin
    high = np.array([columns.max(), rows.max()]) * terrain.resolution + terrain.origin
    middle = np.append(0.5 * (low + high), np.nanmedian(terrain.heights))
    server.scene.set_up_direction("+z")
    _look_at(server, middle, float(np.max(high - low)))


def look_near(server: "ViserServer", terrain: HeightMap, place: tuple[float, float] | None) -> None:
    """Place the camera near a robot on ground too large to see the robot on it.

    Args:
        server: server of the page; the cameras of connected clients move as well.
        terrain: height map of the terrain.
        place: place x, y of the robot [m]; by default the end of the ground where robots begin.
    """
    x_min, x_max, y_min, y_max = terrain.extent
    if max(x_max - x_min, y_max - y_min) <= LARGEST_VIEW:
        return
    if place is None:
        _, columns = np.nonzero(is_ground(terrain.heights))
        place = terrain.origin[0] + columns.min() * terrain.resolution + 0.8, 0.5 * (y_min + y_max)
    ground = float(terrain.height_at(np.array([place]))[0])
    if not is_ground(ground):
        ground = float(np.nanmedian(terrain.heights))
    _look_at(server, np.array([place[0] + 0.2 * LARGEST_VIEW, place[1], ground]), LARGEST_VIEW)


def _look_at(server: "ViserServer", middle: np.ndarray, size: float) -> None:
    position = np.add(middle, [-0.1 * size, -0.5 * size - 1.0, 0.45 * size + 0.8])
    for camera in (server.initial_camera, *(each.camera for each in server.get_clients().values())):
        if np.linalg.norm(np.subtract(camera.look_at, middle)) > NEAR_ENOUGH:
            camera.look_at, camera.position = tuple(middle.tolist()), tuple(position.tolist())
