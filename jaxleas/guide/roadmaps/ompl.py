"""What RRT and PRM share of OMPL: its space, states and solutions.

OMPL asks one question at a time; the ledger answers it from a batch. For that the next samples must
be known, so the searches supply them: to PRM by a valid-state sampler, to RRT (whose binding does
not accept one) by the goal's own sampler with a goal bias of 1.
"""

from collections.abc import Callable
from typing import Any

from jaxleas.guide.roadmaps.ledger import Key, Ledger, key_of
from jaxleas.types import JaxleasError

SAME = 1e-6
"""Distance within which two places count as the same [m]."""


def import_ompl() -> tuple[Any, Any]:
    """Return OMPL's modules `base` and `geometric`, set to log errors only.

    Raises:
        JaxleasError: OMPL is not installed.
    """
    try:
        from ompl import base, geometric, util
    except ImportError as error:
        raise JaxleasError(
            "roadmaps need OMPL: install the extra 'roadmaps', pip install 'jaxleas[roadmaps]'"
        ) from error
    util.setLogLevel(util.LOG_ERROR)
    return base, geometric


def space_of(base: Any, ledger: Ledger, connects: Callable[[Key, Key], bool]) -> Any:
    """Return OMPL's description of the places, which leaves every decision to a function.

    Args:
        base: OMPL's module `base`.
        ledger: ledger of the connections, whose terrain bounds the places.
        connects: function that decides whether a robot gets from one place to another.
    """

    class Validator(base.MotionValidator):
        def checkMotion(self, origin: Any, target: Any) -> bool:  # noqa: N802
            return connects(key_of((origin[0], origin[1])), key_of((target[0], target[1])))

    class Checker(base.StateValidityChecker):
        def isValid(self, state: Any) -> bool:  # noqa: N802
            del state
            return True

    x_min, x_max, y_min, y_max = ledger.connector.places.terrain.extent
    space = base.RealVectorStateSpace(2)
    bounds = base.RealVectorBounds(2)
    for axis, (low, high) in enumerate(((x_min, x_max), (y_min, y_max))):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    space.setBounds(bounds)
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(Checker(information))
    information.setMotionValidator(Validator(information))
    information.setup()
    return information


def state_of(information: Any, place: Key) -> Any:
    """Return a place as a state of OMPL's."""
    state = information.allocState()
    state[0], state[1] = place
    return state


def solution_of(problem: Any) -> list[Key] | None:
    """Return the places of a solved problem, from start to goal; None if it is not solved."""
    if not problem.hasExactSolution():
        return None
    return [key_of((each[0], each[1])) for each in problem.getSolutionPath().getStates()]
