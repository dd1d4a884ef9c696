"""The surfaces that a foot may land on around a root, cut to what is near enough (T 5.2.3)."""

import numpy as np

from jaxleas.contacts.programs.constraints import rotation
from jaxleas.contacts.stepping import Stepping
from jaxleas.contacts.surfaces import ContactSurface
from jaxleas.geometry import Box, Polytope, clip_polygon, pack_polygons, polygons_meet_polytope
from jaxleas.robots import Robot
from jaxleas.terrain import polygon_area_vector

LEAST_PART = 1e-4
"""A part of a surface with a smaller area than this is no candidate [m^2]."""


class CandidateFinder:
    """Finds the candidate surfaces around a root, and the part of each that is near enough."""

    def __init__(
        self,
        surfaces: dict[str, ContactSurface],
        robot: Robot,
        stepping: Stepping,
    ) -> None:
        self.names = list(surfaces)
        self.corners = [surface.vertices for surface in surfaces.values()]
        self.packed = pack_polygons(self.corners)
        reach = [robot.limbs[index].range_of_motion for index in robot.feet]
        if stepping.candidates == "window":
            low = min(float(each.vertices[:, 2].min()) for each in reach)
            high = max(float(each.vertices[:, 2].max()) for each in reach)
            half = 0.5 * stepping.window
            square = Polytope.from_box(Box((-half, -half, low), (half, half, high)))
            reach = [square] * len(reach)
        self.reach: dict[str, Polytope] = dict(zip(robot.foot_names, reach, strict=True))

    def find(
        self, root: np.ndarray, yaw: float, foot: str
    ) -> list[tuple[str, ContactSurface | None]]:
        """Return names, nearest first, with the part of each in reach; None for a whole surface."""
        turn, reach = rotation(yaw), self.reach[foot]
        meets = np.flatnonzero(polygons_meet_polytope((self.packed - root) @ turn, reach))
        found: list[tuple[float, str, ContactSurface | None]] = []
        for index in meets.tolist():
            local = (self.corners[index] - root) @ turn
            inside = clip_polygon(local, reach)
            part = None
            if inside is not local:
                if len(inside) < 3 or np.linalg.norm(polygon_area_vector(inside)) < LEAST_PART:
                    continue
                part = ContactSurface(inside @ turn.T + root)
            apart = float(np.linalg.norm(inside[:, :2].mean(axis=0)))
            found.append((apart, self.names[index], part))
        return [(name, part) for _, name, part in sorted(found, key=lambda each: each[0])]
