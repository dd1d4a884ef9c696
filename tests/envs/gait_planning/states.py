"""States and actions of gait planning, drawn at random, and a robot alone in plain loops."""

from typing import Any

import numpy as np

from jaxleas.envs import HostPool
from jaxleas.envs.gait_planning import GaitPlanning, GaitPlanningConfig, GaitWorldsConfig
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import PlanningState
from jaxleas.terrain import FieldConfig

WORLDS = GaitWorldsConfig(arenas=12, field=FieldConfig(length=5.0, width=3.0))
WEIGHTS = {
    "reward.progress": 25.0,
    "reward.effort": 80.0,
    "reward.stance": 0.01,
    "reward.failure": 1.0,
    "reward.alive": 0.3,
    "reward.change": 0.2,
}


def make_task(**changes: Any) -> GaitPlanning:
    """Return the task."""
    return GaitPlanning(GaitPlanningConfig(**changes), WORLDS)


def drawn_states(task: GaitPlanning, ground: Ground, count: int, seed: int) -> PlanningState:
    """Return valid starts."""
    generator = np.random.default_rng(seed)
    starts = task.draw_starts(ground, generator, 4 * count)
    return HostPool.of(starts).take(np.arange(count))[0]


def drawn_actions(count: int, seed: int, size: float = 0.15) -> np.ndarray:
    """Return actions near the middle of their ranges: 15 numbers, then the support."""
    generator = np.random.default_rng(seed)
    numbers = np.tanh(size * generator.normal(size=(count, 15)))
    return np.concatenate([numbers, generator.integers(5, size=(count, 1))], axis=1)
