"""The shape of a robot: trunk, ranges of motion, what it sees, where it has been."""

from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull

from jaxleas.robots import Robot
from jaxleas.viewer.ground import Colour
from jaxleas.viewer.painted import add_painted, flat, joined, shade, two_sided
from jaxleas.viewer.ribbon import Trail
from jaxleas.viewer.terrain_mesh import Mesh

if TYPE_CHECKING:
    from viser import GlbHandle, PointCloudHandle, ViserServer

    from jaxleas.types import RootPose

ROBOTS: tuple[Colour, ...] = ((38, 112, 190), (214, 118, 28), (60, 150, 76), (150, 84, 170))
"""Colours of the robots, in order."""
INVALID: Colour = (205, 40, 50)
LIMBS: tuple[Colour, ...] = (
    *((200, 60, 60), (220, 175, 40), (70, 160, 90)),
    *((140, 90, 180), (60, 165, 180), (140, 100, 70)),
)
"""Colours of the limbs, in the robot's order."""
GOAL: Colour = (30, 150, 60)
REACH_OPACITY = 0.22
SEEN_LIFT = 0.02  # height of the dots above the ground, which would hide half of each dot [m]
LOW, HIGH = np.array([70.0, 30.0, 140.0]), np.array([255.0, 235.0, 40.0])
"""Colours of what the policy sees, from the lowest height it can distinguish to the highest."""


class RobotShape:
    """A robot on the page; `place` moves it as a whole."""

    def __init__(self, server: "ViserServer", name: str, robot: Robot, colour: Colour) -> None:
        """Draw the robot.

        Args:
            server: server of the page.
            name: name of the shape's node, such as "/robot_0".
            robot: robot whose trunk and ranges of motion are drawn.
            colour: colour of the trunk.
        """
        self._server, self._name = server, name
        self._root = server.scene.add_frame(name, show_axes=False)
        body = _body(robot)
        # Colours are part of a mesh, so there is a body for each colour; one of them is visible.
        self._bodies = [
            add_painted(server, f"{name}/body_{kind}", body, shade(body, np.array(paint, float)))
            for kind, paint in (("valid", colour), ("invalid", INVALID))
        ]
        self._bodies[1].visible = False
        self.reach = [
            add_painted(
                server,
                f"{name}/reach_{limb.name}",
                hull := mesh_of_hull(limb.range_of_motion.vertices),
                shade(hull, limb_colour(index)),
                REACH_OPACITY,
            )
            for index, limb in enumerate(robot.limbs)
        ]
        self.seen = None
        self.trail = Trail(server, f"/trail{name}", colour)
        self._valid = True

    def place(self, pose: "RootPose") -> None:
        """Put the robot at a pose."""
        self._root.position, self._root.wxyz = pose.position, pose.quaternion

    def mark(self, valid: bool) -> None:
        """Colour the body by whether the configuration is valid."""
        if valid != self._valid:
            self._valid = valid
            for body, shown in zip(self._bodies, (valid, not valid), strict=True):
                body.visible = shown

    def show_seen(self, points: Float[np.ndarray, "N 3"], share: Float[np.ndarray, " N"]) -> None:
        """Draw the points that the policy sees.

        Args:
            points: points in the root frame [m].
            share: number from 0 to 1: the lowest and the highest height that the policy can see.
        """
        points = np.add(points, [0.0, 0.0, SEEN_LIFT])
        colours = np.round(LOW + share[:, None] * (HIGH - LOW)).astype(np.uint8)
        if self.seen is None:
            self.seen = self._add_points("seen", points, colours, size=0.035)
            # The page makes a new material whenever colours change, and compiles its program again
            # unless another material uses it: here that of two hidden points inside the body.
            self._add_points("seen_before", np.zeros((2, 3)), colours[:2], size=1e-4)
        else:
            self.seen.points, self.seen.colors = points.astype(np.float32), colours

    def _add_points(
        self, name: str, points: np.ndarray, colours: np.ndarray, size: float
    ) -> "PointCloudHandle":
        return self._server.scene.add_point_cloud(
            f"{self._name}/{name}",
            points,
            colours,
            point_size=size,
            point_shape="circle",
            point_shading="flat",
            precision="float32",
        )

    def show_points(self, visible: bool) -> None:
        """Show or hide what the policy sees."""
        if self.seen is not None:
            self.seen.visible = visible

    def show(self, visible: bool) -> None:
        """Show or hide the robot."""
        self._root.visible = visible


def limb_colour(index: int) -> Float[np.ndarray, " 3"]:
    """Return the colour of a limb, by its index; after the last colour they begin again."""
    return np.array(LIMBS[index % len(LIMBS)], float)


def draw_goal(server: "ViserServer", position: Float[np.ndarray, " 3"]) -> "GlbHandle":
    """Draw a flag at the goal of the robots, still hidden."""
    pole = mesh_of_hull(
        np.array([[x, y, z] for x in (-0.012, 0.012) for y in (-0.012, 0.012) for z in (0.0, 0.7)])
    )
    cloth = Mesh(
        np.array([[0.0, 0.0, 0.7], [0.0, 0.0, 0.48], [0.3, 0.0, 0.59]]),
        np.array([[0, 1, 2]]),
    )
    mesh = joined([pole, two_sided(cloth)])
    colours = np.tile(np.array(GOAL, float), (len(mesh.vertices), 1))
    flag = add_painted(server, "/goal", mesh, colours)
    flag.position, flag.visible = position, False
    return flag


def _body(robot: Robot) -> Mesh:
    """Return the trunk's boxes, and a nose that points along the robot's heading."""
    corners = [np.array(list(product(*zip(box.low, box.high, strict=True)))) for box in robot.trunk]
    front = max(box.high[0] for box in robot.trunk)
    nose = [[front, -0.06, 0.1], [front, 0.06, 0.1], [front, 0.0, 0.2], [front + 0.15, 0.0, 0.1]]
    return joined([mesh_of_hull(each) for each in (*corners, np.array(nose))])


def mesh_of_hull(points: Float[np.ndarray, "P 3"]) -> Mesh:
    """Return the triangles of a convex hull, each with its own corners."""
    hull = ConvexHull(points)
    first, second, third = np.moveaxis(points[hull.simplices], 1, 0)
    outward = np.einsum("ij,ij->i", np.cross(second - first, third - first), hull.equations[:, :3])
    # Counter-clockwise from outside.
    faces = np.where(outward[:, None] > 0.0, hull.simplices, hull.simplices[:, ::-1])
    return flat(Mesh(points, faces))
