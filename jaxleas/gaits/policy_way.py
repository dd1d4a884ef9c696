"""Ways that a policy of gait planning takes, until the goal, a refusal, or too many phases."""

from dataclasses import replace
from typing import Any, NamedTuple

import jax
import numpy as np
from jax import Array

from jaxleas.envs.gait_planning import (
    GaitPlanning,
    GaitWorldsConfig,
    Ground,
    PlanningState,
    command_of,
)
from jaxleas.gaits.gait import Ending, Gait, gait_of
from jaxleas.training import Policy

CAUSES = {
    "unsafe_footholds": "a foothold is too near an edge",
    "trunk_touches": "the terrain reaches the trunk",
    "out_of_reach": "a foot is out of reach",
    "infeasible": "the program is infeasible",
    "unknown": "the program did not converge",
}


class PolicyWay(NamedTuple):
    """A policy's way.

    Attributes:
        gait: states and commands, all accepted.
        cause: why the next transition was refused; "" where none was.
    """

    gait: Gait
    cause: str


def walk_policy(policy: Policy, ground: Ground, start: PlanningState, most: int) -> PolicyWay:
    """Return the way of one robot whose policy proposes its phases.

    Args:
        policy: policy of gait planning.
        ground: ground of the task.
        start: state to begin with, with its goal.
        most: largest number of phases.
    """
    task = GaitPlanning(policy.config, GaitWorldsConfig())
    weights = {f"reward.{name}": value for name, value in policy.config.reward}
    states, commands = [start], []
    ending: Ending = "budget"
    cause = ""
    while len(commands) < most and ending == "budget":
        # An episode of training is cut after fewer phases.
        state = replace(states[-1], step=np.zeros_like(start.step))
        action = jax.tree.map(np.asarray, _act(policy, task.look(ground, state)))
        after, result = task.advance(ground, weights, state, action, ())
        if result.terminated[0]:
            ending, cause = "refused", _cause_of(result)
            break
        states.append(after)
        commands.append(command_of(policy.config, ground, state, action))
        if result.reached[0]:
            ending = "reached"
    return PolicyWay(gait_of(ending, states, commands), cause)


@jax.jit  # of a function of the module: it is compiled once, not for each way
def _act(policy: Policy, seen: dict[str, Array]) -> Any:
    return policy.action(seen)


def _cause_of(result: Any) -> str:
    return next(words for name, words in CAUSES.items() if result.measures[name][0])
