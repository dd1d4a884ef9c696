"""What a new contact must meet, in the order in which it is tested."""

from enum import Enum, auto


class Requirement(Enum):
    """What a test asks of a new contact, or of the foot that is to make it."""

    OTHERS_CLEAR = auto()
    """The legs that stand touch none of each other."""
    LIFTED = auto()
    """The centre of mass can be over the standing feet while the foot leaves its old place."""
    NEAR = auto()
    """A sample of the leg's configurations is near a surface."""
    WITHIN_LIMITS = auto()
    """The sole lies on the surface within the limits of the leg's joints."""
    CLEAR_OF_SCENE = auto()
    CLEAR_OF_LEGS = auto()
    LOADED = auto()
    """The centre of mass can be over the standing feet as the foot lands."""
    ROBUST = auto()
    """The posture is in equilibrium, robustly enough."""


Tally = dict[Requirement, int]
"""Number of places that each test left, in the order of the tests."""


def count_left(tally: Tally | None, requirement: Requirement, left: int) -> None:
    """Add to the number of places that a test left."""
    if tally is not None:
        tally[requirement] = tally.get(requirement, 0) + left
