"""LEAS steering: a root walks towards goals over terrain that it sees only locally (T ch. 3)."""

from jaxleas.envs.steering.config import (
    MotionLimits,
    RewardWeights,
    SteeringConfig,
    TerrainConfig,
)
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import (
    ICRA81,
    THESIS144,
    THESIS145,
    ObservationLayout,
    layout_named,
)
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import draw_starts
from jaxleas.envs.steering.state import Plan, SeenResult, SteeringResult, SteeringState
from jaxleas.envs.steering.task import Steering
from jaxleas.envs.steering.world import World, make_world

__all__ = [
    "ICRA81",
    "THESIS144",
    "THESIS145",
    "MotionLimits",
    "ObservationLayout",
    "Plan",
    "RewardParams",
    "RewardWeights",
    "SeenResult",
    "Steering",
    "SteeringConfig",
    "SteeringEnv",
    "SteeringResult",
    "SteeringState",
    "TerrainConfig",
    "World",
    "draw_starts",
    "layout_named",
    "make_world",
]
