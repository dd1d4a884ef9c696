"""Starts and goals, anywhere on the fields (D sec. IV-B)."""

from typing import Any

import jax
import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.envs import Starts
from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.footholds import footholds_are_safe, trunk_is_free
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import Phases, PlanningState, lowest_foothold, rotate
from jaxleas.envs.gait_planning.quadruped import FEET
from jaxleas.envs.gait_planning.reach import reach_slack

ROUNDS = 8
"""Places that are tried for each start."""
TRIES = 24
"""Places that are tried for each foot."""
SPREAD = (0.12, 0.08)
"""Largest offset of a foot from its nominal place at a start, ahead and aside [m]."""


def draw_starts(
    config: GaitPlanningConfig,
    ground: Ground,
    generator: np.random.Generator,
    count: int,
    distance: tuple[float, float],
) -> Starts:
    """Draw starts at rest on four feet, and goals on ground where a foot may stand.

    Each candidate is the first that is valid of several places on its field.

    Args:
        config: configuration of the task.
        ground: fields.
        generator: generator of random numbers.
        count: number of candidates.
        distance: range of the distance to the goal [m].
    """
    field = np.repeat(generator.integers(len(ground.kind), size=count), ROUNDS)
    state, valid = _draw_places(config, ground, generator, field, distance)
    valid = valid.reshape(count, ROUNDS)
    chosen = ROUNDS * np.arange(count) + valid.argmax(axis=1)
    picked = jax.tree.map(lambda leaf: leaf[chosen], state)
    kind = ground.kind[field[chosen]]
    answer: dict[str, Any] = {"state": picked, "valid": valid.any(axis=1), "group": kind}
    return Starts(**answer)


def _draw_places(
    config: GaitPlanningConfig,
    ground: Ground,
    generator: np.random.Generator,
    field: Int[np.ndarray, " N"],
    distance: tuple[float, float],
) -> tuple[PlanningState, Bool[np.ndarray, " N"]]:
    """Return a start and a goal on each field, and which are valid."""
    count = len(field)
    place = generator.uniform(size=(count, 2)) * ground.size
    yaw = generator.uniform(-np.pi, np.pi, count)
    feet, found = _draw_feet(config, ground, generator, (field, place, yaw))
    support = np.zeros(count, np.int32)
    height = lowest_foothold(feet, support) + config.robot.com_height
    phase = Phases(
        com=np.concatenate([place, height[:, None]], axis=1).astype(np.float32),
        yaw=yaw.astype(np.float32),
        velocity=np.zeros((count, 2), np.float32),
        feet=feet.astype(np.float32),
        support=support,
    )
    bearing = generator.uniform(-np.pi, np.pi, count)
    direction = np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    goal = place + direction * generator.uniform(*distance, count)[:, None]
    valid = found & (reach_slack(config.robot, phase) > 0.0) & ground.safe_at(field, goal)
    valid &= footholds_are_safe(ground, field, phase)
    valid &= trunk_is_free(config.robot, ground, field, phase)
    state = PlanningState(
        phase=phase,
        field=field.astype(np.int32),
        goal=goal.astype(np.float32),
        grounded=np.ones((count, len(FEET)), np.int32),
        step=np.zeros(count, np.int32),
    )
    return state, valid


def _draw_feet(
    config: GaitPlanningConfig,
    ground: Ground,
    generator: np.random.Generator,
    bases: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[Float[np.ndarray, "N 4 3"], np.ndarray]:
    """Return feet at the first safe of some places around the nominal one, and whether all are."""
    field, place, yaw = bases
    count = len(field)
    offset = generator.uniform(-1.0, 1.0, (count, len(FEET), TRIES, 2)) * SPREAD
    points = config.robot.nominal[None, :, None, :2] + offset
    places = place[:, None, None] + rotate(yaw, points)
    safe = ground.safe_at(field[:, None, None], places)
    first = safe.argmax(axis=2)[..., None, None]
    chosen = np.take_along_axis(places, first, axis=2)[:, :, 0]
    heights = ground.heights_at(field[:, None], chosen)
    found = np.all(np.any(safe, axis=2), axis=1)
    return np.concatenate([chosen, heights[..., None]], axis=-1), found
