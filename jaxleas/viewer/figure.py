"""What is drawn of a robot: trunk, ranges of motion, what it sees, where it has been."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from jaxleas.guide.standing import Pose
from jaxleas.robots import Robot
from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.scene import Scene
from jaxleas.viewer.terrain_mesh import Mesh, mesh_of_edges, mesh_of_map, mesh_of_polygons

if TYPE_CHECKING:
    from viser import ViserServer

Colour = tuple[int, int, int]

SKY: Colour = (226, 233, 240)
DEEP, TALL = np.array([84.0, 99.0, 118.0]), np.array([196.0, 178.0, 142.0])
"""Colours of the lowest and of the highest ground."""
OBSTACLE = np.array([168.0, 88.0, 70.0])
EDGE: Colour = (58, 64, 74)
EDGE_WIDTH = 0.012  # [m]
NO_SHADOW: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}
ROBOTS: tuple[Colour, ...] = ((38, 112, 190), (214, 118, 28), (60, 150, 76), (150, 84, 170))
"""Of the robots side by side, one after another."""
INVALID: Colour = (205, 40, 50)
LIMBS: dict[str, Colour] = {"left": (200, 60, 60), "right": (220, 175, 40)}
GOAL: Colour = (30, 150, 60)
LARGEST_VIEW = 9.0
"""Ground of more metres than this is not shown as a whole when robots are driven [m]."""
LOW, HIGH = np.array([70.0, 30.0, 140.0]), np.array([255.0, 235.0, 40.0])
"""Colours of what the policy sees, from the lowest height that it can tell to the highest."""


def draw_terrain(server: "ViserServer", terrain: HeightMap, scene: Scene | None) -> None:
    """Draw a terrain: a scene's polygons, or else the height map; and look at it from the south.

    Args:
        server: of the page.
        terrain: to be looked at.
        scene: whose surfaces and obstacles are drawn, where the terrain was one.
    """
    low, high = float(np.nanmin(terrain.heights)), float(np.nanmax(terrain.heights))
    server.scene.set_background_image(np.full((1, 1, 3), SKY, np.uint8))
    if scene is None:
        _add_mesh(server, "/terrain", mesh_of_map(terrain), (low, high))
    else:
        _add_mesh(server, "/terrain", mesh_of_polygons(scene.surfaces.values()), (low, high))
        if scene.obstacles:
            obstacles = mesh_of_polygons(scene.obstacles.values())
            _add_mesh(server, "/obstacles", obstacles, (low, high), OBSTACLE)
        edges = mesh_of_edges(scene.polygons, EDGE_WIDTH)
        server.scene.add_mesh_simple(
            "/edges", edges.vertices, edges.faces, color=EDGE, side="double", **NO_SHADOW
        )
    _light(server)
    look_at_all(server, terrain)


def _light(server: "ViserServer") -> None:
    """Light the scene evenly from above, and more from the south-west.

    Neither shadows nor an environment's reflections: a browser that draws in software spends more
    than half of its time on them.
    """
    scene = server.scene
    scene.configure_environment_map(None)
    scene.configure_default_lights(enabled=False)
    scene.add_light_hemisphere("/light/sky", ground_color=(176, 182, 196), intensity=2.5)
    scene.add_light_directional("/light/sun", intensity=2.6, position=(-4.0, -6.0, 9.0))


def _add_mesh(
    server: "ViserServer",
    name: str,
    mesh: Mesh,
    heights: tuple[float, float],
    tallest: np.ndarray = TALL,
) -> None:
    """Add a mesh that is the brighter, the higher."""
    import trimesh

    low, high = heights
    share = (mesh.vertices[:, 2:] - low) / max(high - low, 0.5)
    colours = DEEP + np.clip(share, 0.0, 1.0) * (tallest - DEEP)
    if tallest is not TALL:
        colours = 0.4 * colours + 0.6 * tallest
    solid = np.column_stack([colours, np.full(len(colours), 255.0)]).astype(np.uint8)
    server.scene.add_mesh_trimesh(
        name,
        trimesh.Trimesh(mesh.vertices, mesh.faces, vertex_colors=solid, process=False),
        **NO_SHADOW,
    )


def look_at_all(server: "ViserServer", terrain: HeightMap) -> None:
    """Place the camera so that the whole ground is in view."""
    rows, columns = np.nonzero(~np.isnan(terrain.heights))
    low = np.array([columns.min(), rows.min()]) * terrain.resolution + terrain.origin
    high = np.array([columns.max(), rows.max()]) * terrain.resolution + terrain.origin
    middle = np.append(0.5 * (low + high), np.nanmedian(terrain.heights))
    server.scene.set_up_direction("+z")
    _look_at(server, middle, float(np.max(high - low)))


def look_at_start(server: "ViserServer", terrain: HeightMap, start: Pose) -> None:
    """On ground too large to make out a robot on it, place the camera near the start."""
    x_min, x_max, y_min, y_max = terrain.extent
    if max(x_max - x_min, y_max - y_min) > LARGEST_VIEW:
        ahead = 0.2 * LARGEST_VIEW * np.array([np.cos(start.yaw), np.sin(start.yaw), 0.0])
        _look_at(server, start.position + ahead - [0.0, 0.0, 1.0], LARGEST_VIEW)


def _look_at(server: "ViserServer", middle: np.ndarray, size: float) -> None:
    server.initial_camera.look_at = tuple(middle.tolist())
    server.initial_camera.position = (
        middle[0] - 0.1 * size,
        middle[1] - 0.5 * size - 1.0,
        middle[2] + 0.45 * size + 0.8,
    )


class Figure:
    """A robot on the page; moved as a whole by `place`."""

    def __init__(self, server: "ViserServer", name: str, robot: Robot, colour: Colour) -> None:
        """Draw it.

        Args:
            server: of the page.
            name: of its node, such as "/robot_0".
            robot: whose trunk and ranges of motion are drawn.
            colour: of the trunk.
        """
        self._server, self._name, self._colour = server, name, colour
        scene = server.scene
        self._root = scene.add_frame(name, show_axes=False)
        self._trunk = [
            scene.add_box(
                f"{name}/trunk_{index}",
                color=colour,
                dimensions=tuple(np.subtract(box.high, box.low).tolist()),
                position=tuple((0.5 * np.add(box.high, box.low)).tolist()),
                opacity=0.9,
                **NO_SHADOW,
            )
            for index, box in enumerate(robot.trunk)
        ]
        # A nose: where the heading points.
        front = max(box.high[0] for box in robot.trunk)
        nose = np.array(
            [[front, -0.06, 0.1], [front, 0.06, 0.1], [front, 0, 0.2], [front + 0.15, 0, 0.1]]
        )
        scene.add_mesh_simple(
            f"{name}/nose", nose, _hull(nose), color=(245, 245, 245), side="double", **NO_SHADOW
        )
        self.reach = [
            scene.add_mesh_simple(
                f"{name}/reach_{limb.name}",
                limb.range_of_motion.vertices,
                _hull(limb.range_of_motion.vertices),
                color=LIMBS.get(limb.name, colour),
                opacity=0.18,
                **NO_SHADOW,
            )
            for limb in robot.limbs
        ]
        self.seen = None

    def place(self, pose: Pose) -> None:
        """Put the robot at a pose."""
        half = 0.5 * pose.yaw
        self._root.position = pose.position
        self._root.wxyz = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])

    def mark(self, valid: bool) -> None:
        """Show by the trunk's colour whether the configuration is valid."""
        for box in self._trunk:
            box.color = self._colour if valid else INVALID

    def show_seen(self, points: Float[np.ndarray, "N 3"], share: Float[np.ndarray, " N"]) -> None:
        """Draw the points that the policy sees.

        Args:
            points: in the world [m].
            share: 0 for the lowest height that the policy can tell, 1 for the highest.
        """
        colours = np.round(LOW + share[:, None] * (HIGH - LOW)).astype(np.uint8)
        if self.seen is None:
            self.seen = self._server.scene.add_point_cloud(
                f"/seen{self._name}",
                points,
                colours,
                point_size=0.035,
                point_shape="circle",
                point_shading="flat",
                precision="float32",
            )
        else:
            self.seen.points, self.seen.colors = points.astype(np.float32), colours

    def show_points(self, visible: bool) -> None:
        """Show or hide what the policy sees."""
        if self.seen is not None:
            self.seen.visible = visible

    def show(self, visible: bool) -> None:
        """Show or hide the robot."""
        self._root.visible = visible

    def show_trail(self, positions: Float[np.ndarray, "T 3"]) -> None:
        """Draw where the root has been."""
        draw_line(self._server, f"/trail{self._name}", positions, self._colour)


def draw_line(
    server: "ViserServer", name: str, positions: Float[np.ndarray, "T 3"], colour: Colour
) -> None:
    """Draw a line through positions [m], in the place of one of the same name."""
    if len(positions) < 2:
        server.scene.remove_by_name(name)
        return
    segments = np.stack([positions[:-1], positions[1:]], axis=1).astype(np.float32)
    server.scene.add_line_segments(name, segments, colour, thickness=0.02)


def _hull(points: Float[np.ndarray, "P 3"]) -> np.ndarray:
    """Return the triangles of a convex hull, counter-clockwise from outside."""
    hull = ConvexHull(points)
    first, second, third = np.moveaxis(points[hull.simplices], 1, 0)
    outward = np.einsum("ij,ij->i", np.cross(second - first, third - first), hull.equations[:, :3])
    return np.where(outward[:, None] > 0.0, hull.simplices, hull.simplices[:, ::-1])
