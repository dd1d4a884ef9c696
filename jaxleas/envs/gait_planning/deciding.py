"""CROC's verdicts on transitions from phases to their candidates."""

import jax
import numpy as np

from jaxleas.dynamics import Discretisation, Ended, decide_transitions, has_compiler
from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.phases import Phases
from jaxleas.envs.gait_planning.transitions import transitions_of


def decide_phases(
    config: GaitPlanningConfig,
    phase: Phases,
    candidate: Phases,
    times: np.ndarray,
    asked: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return which transitions CROC accepts, and of which it found no verdict.

    Args:
        config: configuration of the task.
        phase: present phases.
        candidate: phases that follow.
        times: t_E* and t_S [s].
        asked: which transitions are asked; others are not accepted.
    """
    feasible = np.zeros(len(asked), bool)
    unknown = np.zeros(len(asked), bool)
    # JAX compiles a program for each number of transitions: without numba it gets all of them.
    chosen = np.flatnonzero(asked if has_compiler() else np.ones_like(asked))
    if len(chosen):
        before, after = jax.tree.map(lambda leaf: leaf[chosen], (phase, candidate))
        transitions = transitions_of(config, before, after, times[chosen])
        where = Discretisation(instants=config.instants)
        answers = decide_transitions(transitions, config.least_margin, where)
        feasible[chosen] = asked[chosen] & answers.feasible(config.least_margin)
        unknown[chosen] = answers.ended == Ended.NOT_CONVERGED
    return feasible, unknown
