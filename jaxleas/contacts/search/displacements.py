"""The displacements between the feet that one step allows: one exact convex polytope.

In model `feet` the step's polytope says all. In model `two_com` two centres of mass must have a
place besides: c_i lies in p_o + C_oi and in p_m + C_mi, so that d = p_m - p_o is in the Minkowski
difference C_oi - C_mi, a polytope, too. Each is found once for a pair of feet and the yaw between.
"""

from functools import cache

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.search.bodies import Body, body_of, faces_of_sum, hull_of

SLACK = 1e-7
"""Every face of the displacements is moved outwards by this [m]: as much as a placement of feet may
violate a constraint, and far more than arithmetic can be wrong by."""
_SAME_YAW = 12  # decimals of a yaw [rad] within which a polytope is used again
_SIDES = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
_LEAST_SOLE = 1e-6  # half size of a point foot's sole, so that a place over it has a volume [m]


class Displacements:
    """The displacements of a problem's steps; each polytope is made once."""

    def __init__(self, problem: ContactProblem) -> None:
        self._problem = problem
        self.of = cache(self._of)
        """The displacements p_m - p_o of a step, in world axes: `_of`, remembered."""
        self._local = cache(self._in_frame)
        self._com = cache(self._of_com)
        self._reach = cache(self._of_step)

    def _of(self, moving: str, standing: str, yaw: float, standing_yaw: float) -> Body | None:
        """Return the displacements of a step; None where not a single one is allowed.

        Args:
            moving: name of the foot that moves.
            standing: name of the foot that stands.
            yaw: heading with which the one lands [rad].
            standing_yaw: heading with which the other stands [rad].
        """
        landing = self._problem.model == "feet"
        frame, between = (yaw, 0.0) if landing else (standing_yaw, yaw - standing_yaw)
        local = self._local(moving, standing, round(between, _SAME_YAW))
        return None if local is None else local.turned(frame)

    def _in_frame(self, moving: str, standing: str, between: float) -> Body | None:
        reach = self._reach(moving, standing)
        if self._problem.model == "feet" or reach is None:
            return reach
        normals, offsets = [reach.normals], [reach.offsets]
        for over in (0, 1):
            here, there = self._com(standing, over == 0), self._com(moving, over == 1)
            if here is None or there is None:  # no place over a sole
                return None
            there = there.turned(between).reversed()
            faces = faces_of_sum(here, there)
            bounds = here.support(faces) + there.support(faces) + SLACK
            cuts = bounds < reach.support(faces)
            normals.append(faces[cuts])
            offsets.append(bounds[cuts])
        if len(normals[1]) + len(normals[2]) == 0:
            return reach
        return body_of(np.concatenate(normals), np.concatenate(offsets))

    def _of_step(self, moving: str, standing: str) -> Body | None:
        if self._problem.model == "feet":
            reach = self._problem.polytopes.reach(standing, moving)
            return body_of(-reach.normals, reach.offsets + SLACK)
        reach = self._problem.polytopes.reach(moving, standing)
        return body_of(reach.normals, reach.offsets + SLACK)

    def _of_com(self, name: str, over: bool) -> Body | None:
        """Return where the centre of mass may be from a foot, over it or not."""
        reach = self._problem.polytopes.com[name]
        if not over:
            return hull_of(reach.vertices)
        sides = np.repeat(np.maximum(self._problem.half_sizes[name], _LEAST_SOLE), 2)
        normals = np.concatenate([reach.normals, _SIDES])
        return body_of(normals, np.concatenate([reach.offsets + SLACK, sides + SLACK]))
