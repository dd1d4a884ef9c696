"""The links of a robot in physics on the page; colours of feet say how near an edge is."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps import UNSAFE
from jaxleas.physics import Body, import_mujoco
from jaxleas.terrain import SceneEdges
from jaxleas.types import matrix_of
from jaxleas.viewer.ground import Colour
from jaxleas.viewer.painted import add_painted, joined, shade
from jaxleas.viewer.robot_shape import mesh_of_hull
from jaxleas.viewer.terrain_mesh import Mesh

if TYPE_CHECKING:
    from viser import GlbHandle, ViserServer

LINK: Colour = (92, 104, 122)
NEARNESS: tuple[tuple[float, Colour, str], ...] = (
    (UNSAFE, (205, 40, 50), "red"),
    (0.03, (236, 130, 30), "orange"),
    (0.07, (228, 204, 60), "yellow"),
    (np.inf, (60, 160, 80), "green"),
)
"""Distances from an edge up to which a foot has a colour [m]; the first is unsafe."""
ROUND = 10
"""Corners of a circle of what is round."""


class LeggedShape:
    """A robot's links on the page; `place` moves them.

    Args:
        server: server of the page.
        body: robot.
        edges: edges that feet are to keep away from.
    """

    def __init__(self, server: "ViserServer", body: Body, edges: SceneEdges) -> None:
        mujoco = import_mujoco()
        self._mujoco = mujoco
        self._model = model = mujoco.MjModel.from_xml_string(body.mjcf)
        self._data = mujoco.MjData(model)
        self._edges = edges
        feet = [model.geom(f"{name}_FOOT").id for name in body.feet]
        self._links: list[tuple[int, Any]] = []
        self._feet: list[list[GlbHandle]] = []
        for link in range(1, model.nbody):
            name = f"/walker/{model.body(link).name}"
            self._links.append((link, server.scene.add_frame(name, show_axes=False)))
            own = [each for each in np.flatnonzero(model.geom_bodyid == link) if each not in feet]
            meshes = [mesh for each in own if (mesh := _mesh_of(model, int(each))) is not None]
            if meshes:
                mesh = joined(meshes)
                add_painted(server, f"{name}/shape", mesh, shade(mesh, np.array(LINK, float)))
        for foot, label in zip(feet, body.feet, strict=True):
            ball = _mesh_of(model, foot)
            assert ball is not None
            name = f"/walker/{model.body(int(model.geom_bodyid[foot])).name}/{label}"
            paints = [(word, np.array(colour, float)) for _, colour, word in NEARNESS]
            self._feet.append(
                [add_painted(server, f"{name}_{word}", ball, shade(ball, p)) for word, p in paints]
            )
        self._shown = [-1] * len(feet)

    def place(self, coordinates: Float[np.ndarray, " 7+J"], feet: Float[np.ndarray, "E 3"]) -> None:
        """Put the robot somewhere, and colour its feet.

        Args:
            coordinates: position and quaternion of the root, and angles of the joints.
            feet: positions of the feet [m].
        """
        self._data.qpos[:] = coordinates
        self._mujoco.mj_kinematics(self._model, self._data)
        for link, node in self._links:
            node.position, node.wxyz = self._data.xpos[link].copy(), self._data.xquat[link].copy()
        distances = self._edges.distance(feet[:, :2])
        bounds = [bound for bound, _, _ in NEARNESS]
        for foot, colour in enumerate(np.searchsorted(bounds, distances, side="right").tolist()):
            if colour != self._shown[foot]:
                self._shown[foot] = colour
                for number, node in enumerate(self._feet[foot]):
                    node.visible = number == colour


def _mesh_of(model: Any, geom: int) -> Mesh | None:
    """Return a box, ball, capsule or cylinder in the frame of its link; None for other shapes."""
    kinds = import_mujoco().mjtGeom
    kind, size = model.geom_type[geom], model.geom_size[geom]
    if kind == kinds.mjGEOM_BOX:
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        points = signs * size
    elif kind == kinds.mjGEOM_SPHERE:
        points = _ball(size[0])
    elif kind == kinds.mjGEOM_CAPSULE:
        ends = np.array([0.0, 0.0, size[1]])
        points = np.concatenate([_ball(size[0]) + ends, _ball(size[0]) - ends])
    elif kind == kinds.mjGEOM_CYLINDER:
        circle = size[0] * _circle()
        ends = [np.column_stack([circle, np.full(ROUND, z)]) for z in (-size[1], size[1])]
        points = np.concatenate(ends)
    else:
        return None
    turned = points @ matrix_of(model.geom_quat[geom]).T
    return mesh_of_hull(turned + model.geom_pos[geom])


def _circle() -> Float[np.ndarray, "N 2"]:
    angles = 2.0 * np.pi * np.arange(ROUND) / ROUND
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _ball(radius: float) -> Float[np.ndarray, "N 3"]:
    """Return points of a ball."""
    rings = [
        np.column_stack([np.cos(tilt) * _circle(), np.full(ROUND, np.sin(tilt))])
        for tilt in np.radians((-54.0, -18.0, 18.0, 54.0))
    ]
    return radius * np.concatenate([*rings, [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])
