"""LEAS steering: a root that walks towards goals over terrain it sees a little of (T ch. 3)."""

from jaxleas.envs.steering.config import MotionLimits, RewardWeights, SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import (
    ICRA81,
    THESIS144,
    THESIS145,
    ObservationLayout,
    layout_named,
)
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import draw_picks, draw_starts, restart_where, take
from jaxleas.envs.steering.state import Outcome, Plan, SteeringState
from jaxleas.envs.steering.world import World, make_world

__all__ = [
    "ICRA81",
    "THESIS144",
    "THESIS145",
    "MotionLimits",
    "ObservationLayout",
    "Outcome",
    "Plan",
    "RewardParams",
    "RewardWeights",
    "SteeringConfig",
    "SteeringEnv",
    "SteeringState",
    "World",
    "draw_picks",
    "draw_starts",
    "layout_named",
    "make_world",
    "restart_where",
    "take",
]
