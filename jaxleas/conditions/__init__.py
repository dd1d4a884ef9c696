"""What a valid configuration is: reachability, collision, and how conditions combine."""

from jaxleas.conditions.collision import collision
from jaxleas.conditions.condition import MARGIN_LIMIT, VOID_IN_ROOT, Condition, all_of
from jaxleas.conditions.exact import (
    exact_collision,
    exact_reachability,
    exact_strict_reachability,
    reconfirm,
)
from jaxleas.conditions.footprint import footprint_points, is_under_root
from jaxleas.conditions.foresight import Foresight, LookAround, Pick, everyone
from jaxleas.conditions.reachability import reachability, strict_reachability

__all__ = [
    "MARGIN_LIMIT",
    "VOID_IN_ROOT",
    "Condition",
    "Foresight",
    "LookAround",
    "Pick",
    "all_of",
    "collision",
    "everyone",
    "exact_collision",
    "exact_reachability",
    "exact_strict_reachability",
    "footprint_points",
    "is_under_root",
    "reachability",
    "reconfirm",
    "strict_reachability",
]
