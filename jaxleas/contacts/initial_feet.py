"""Where the feet stand first: on the ground beside the first root of a guide path."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import FootPose
from jaxleas.contacts.reference import reference_foothold
from jaxleas.contacts.stepping import NoGroundError
from jaxleas.contacts.surfaces import ContactSurface
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.robots import Robot
from jaxleas.types import GuidePath

MOST_ASIDE = 0.2
"""A foot that finds no ground within this distance [m] of its reference place cannot stand."""


def initial_feet(
    guide: GuidePath, surfaces: dict[str, ContactSurface], robot: Robot
) -> dict[str, FootPose]:
    """Stand each foot on the ground nearest to its reference place beside the first root."""
    yaw, root = float(wrap_angle_on_host(guide.yaw[0])), guide.position[0]
    legs = [robot.limbs[index].range_of_motion for index in robot.feet]
    lowest = min(float(reach.vertices[:, 2].min()) for reach in legs)
    poses = {}
    for foot in robot.foot_names:
        place = reference_foothold(robot, foot, root, yaw)
        found = [nearest_below(surface, place) for surface in surfaces.values()]
        reachable = [
            (aside, -float(point[2]), tuple(point.tolist()))
            for point, aside in found
            if aside <= MOST_ASIDE and lowest - 0.1 <= point[2] - root[2] <= 0.0
        ]
        if not reachable:
            raise NoGroundError(
                f"the guide starts where {foot} cannot stand: no surface lies within"
                f" {MOST_ASIDE:g} m of ({place[0]:.2f}, {place[1]:.2f}) and within a leg's length"
                f" below the root at {root[2]:.2f} m",
                -1,
            )
        _, _, point = min(reachable)  # the nearest; of those right below, the highest
        poses[foot] = FootPose(np.array(point), yaw)
    return poses


def nearest_below(
    surface: ContactSurface, place: Float[np.ndarray, " 3"]
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Return the point of a surface that is horizontally nearest to a place, and its distance [m].

    A wall has no such point: its distance is infinite.
    """
    if abs(surface.normal[2]) < 1e-3:
        return place, math.inf
    corners, target = surface.vertices[:, :2], place[:2]
    along = np.roll(corners, -1, axis=0) - corners
    outside = along[:, 1] * (target - corners)[:, 0] - along[:, 0] * (target - corners)[:, 1]
    if (outside > 0.0).any():  # counter-clockwise from above: right of an edge is outside
        share = np.einsum("vk,vk->v", target - corners, along) / np.einsum("vk,vk->v", along, along)
        on_edges = corners + np.clip(share, 0.0, 1.0)[:, None] * along
        target = on_edges[np.argmin(np.linalg.norm(on_edges - place[:2], axis=1))]
    z = (surface.offset - surface.normal[:2] @ target) / surface.normal[2]
    return np.array([*target, z]), float(np.linalg.norm(target - place[:2]))
