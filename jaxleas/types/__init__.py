"""Values that cross rooms. This room imports no other room.

`RootMotion` is a pytree, and is imported only on access, so that code that reads and draws files
does not load JAX.
"""

from typing import TYPE_CHECKING, Any

from jaxleas.types.errors import InputError, JaxleasError
from jaxleas.types.ground import NO_GROUND, is_ground
from jaxleas.types.paths import GuidePath, cut_walks
from jaxleas.types.poses import Pose, RootPose
from jaxleas.types.queries import Query
from jaxleas.types.stances import Contact, Stance, SupportPhase
from jaxleas.types.verdict import CAUSES, Cause, PathProgress, PlannerMeasures, Verdict

if TYPE_CHECKING:
    from jaxleas.types.root import RootMotion

__all__ = [
    "CAUSES",
    "NO_GROUND",
    "Cause",
    "Contact",
    "GuidePath",
    "InputError",
    "JaxleasError",
    "PathProgress",
    "PlannerMeasures",
    "Pose",
    "Query",
    "RootMotion",
    "RootPose",
    "Stance",
    "SupportPhase",
    "Verdict",
    "cut_walks",
    "is_ground",
]


def __getattr__(name: str) -> Any:
    if name != "RootMotion":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from jaxleas.types.root import RootMotion

    return RootMotion
