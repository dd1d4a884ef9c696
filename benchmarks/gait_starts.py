"""Starts on fields of one kind, as gait planners and their tracker are judged on them."""

import numpy as np

from jaxleas.envs.gait_planning import (
    GaitPlanning,
    GaitPlanningConfig,
    GaitWorldsConfig,
    Ground,
    PlanningState,
    Shares,
)
from jaxleas.gaits import taken
from jaxleas.terrain import EVALUATION_SEED, FIELD_KINDS, TUNING_SEED

FIELDS = 20


def starts_on(
    config: GaitPlanningConfig, kind: str, draws: int, most: int, held_out: bool, shift: int = 0
) -> tuple[Ground, PlanningState]:
    """Return fields of one kind, and valid starts on them with goals 2 to 5 m away.

    Args:
        config: configuration of the task.
        kind: kind of field.
        draws: number of starts that are drawn.
        most: largest number of valid ones that are kept.
        held_out: whether fields are those for tuning, instead of those that nothing was tuned on.
        shift: number added to the fields' seeds.
    """
    shares = {name: float(name == kind) for name in FIELD_KINDS}
    task = GaitPlanning(config, GaitWorldsConfig(shares=Shares(**shares)))
    first = TUNING_SEED if held_out else EVALUATION_SEED
    first += FIELDS * FIELD_KINDS.index(kind) + shift
    ground = task.make_world(range(first, first + FIELDS), True)
    drawn = task.draw_starts(ground, np.random.default_rng(first), draws, True)
    return ground, taken(drawn.state, np.flatnonzero(drawn.valid)[:most])
