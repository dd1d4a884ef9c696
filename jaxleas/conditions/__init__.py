"""Conditions of a valid configuration: reachability, collision, and their combinations."""

from jaxleas.conditions.collision import Collision, collision
from jaxleas.conditions.condition import (
    MARGIN_LIMIT,
    VOID_IN_ROOT,
    AllOf,
    Condition,
    Judge,
    OnPoints,
    all_of,
    read_from,
    stated_points,
    with_points,
)
from jaxleas.conditions.exact import (
    exact_collision,
    exact_reachability,
    exact_strict_reachability,
    reconfirm,
)
from jaxleas.conditions.footprint import footprint_points, is_under_root
from jaxleas.conditions.foresight import Foresight, LookAround, Pick, everyone
from jaxleas.conditions.points import extended, union_of_points
from jaxleas.conditions.reachability import (
    Reachability,
    StrictReachability,
    reachability,
    strict_reachability,
)

__all__ = [
    "MARGIN_LIMIT",
    "VOID_IN_ROOT",
    "AllOf",
    "Collision",
    "Condition",
    "Foresight",
    "Judge",
    "LookAround",
    "OnPoints",
    "Pick",
    "Reachability",
    "StrictReachability",
    "all_of",
    "collision",
    "everyone",
    "exact_collision",
    "exact_reachability",
    "exact_strict_reachability",
    "extended",
    "footprint_points",
    "is_under_root",
    "reachability",
    "read_from",
    "reconfirm",
    "stated_points",
    "strict_reachability",
    "union_of_points",
    "with_points",
]
