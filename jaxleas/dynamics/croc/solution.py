"""Answers to contact transitions, and how their search ended."""

from enum import IntEnum
from typing import NamedTuple

from jaxtyping import Bool, Float, Int

from jaxleas.dynamics.croc.curves import namespace
from jaxleas.dynamics.croc.transitions import LEAST_MARGIN, Numbers

TOLERANCE = 1e-6  # gap between the margin and its upper bound at which a search ends [1]
CLOSE = 1e-5  # largest gap of a known margin: the last digits may drown in rounding [1]
MOST_ITERATIONS = 40
RESIDUAL = 1e-5  # largest error of the balance of forces [body weights, body weights m]
PROXIMAL = 1e-7  # weight that keeps forces near where they are, where nothing else holds them
NARROWEST = 1e-8  # least pivot of a support's wrenches [m^2]: 0.1 mm wide at least
ROOM = 0.3  # distance of the first margin from the smallest slack [1]
CAUTIOUS, BOLD = 0.99, 0.999  # share of the way to the boundary: at first, and near the end
WORSE = 100.0  # a step that makes the gap this many times as large broke down: it is not taken
UNBOUNDED = 1e-9  # share of the first duals' error below which the gap bounds all margins
NEAR = 1e-2  # gap from which on steps are bold


class Ended(IntEnum):
    """How the search for a margin ended."""

    CONVERGED = 0
    NOT_CONVERGED = 1
    """The margin is no verdict: out of iterations, or numbers too large for doubles."""
    UNSUPPORTED = 2
    """A phase stands on nothing, on one point or on a line: no margin exists."""
    DECIDED = 3
    """The margin lies on the proven side of the one that was asked for; the largest is unknown."""


class Solutions(NamedTuple):
    """Margins of a batch of transitions, with what proves them.

    Attributes:
        margin: the largest margin [1], to 1e-5; the best found where the search did not converge,
            minus infinity without support.
        free_point: free control point of the curve in the world [m].
        forces: force of each point at each force instant [body weights].
        ended: how the search ended, a number of `Ended`.
        iterations: number of iterations.
    """

    margin: Float[Numbers, "*batch"]
    free_point: Float[Numbers, "*batch 3"]
    forces: Float[Numbers, "*batch S W P 3"]
    ended: Int[Numbers, "*batch"]
    iterations: Int[Numbers, "*batch"]

    def feasible(self, least: float = LEAST_MARGIN) -> Bool[Numbers, "*batch"]:
        """Return where the margin is known and large enough.

        Args:
            least: least margin of an accepted transition; 0 for the plain linear program.
        """
        xp = namespace(self.margin)
        is_known = xp.logical_or(self.ended == Ended.CONVERGED, self.ended == Ended.DECIDED)
        return xp.logical_and(is_known, self.margin >= least)
