"""One method of a comparison: what rolls out the starts of a cell."""

from collections.abc import Callable

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.roll_outs import CellRollOut, roll_out_cell
from jaxleas.evaluation.starts import Grounds, Starts
from jaxleas.guide import SteeringMethod

Contender = Callable[[Grounds, Starts, int], CellRollOut]
"""Rolls out the starts of a cell for at most the given number of steps, with a roadmap or not."""


def contender(env: SteeringEnv, method: SteeringMethod) -> Contender:
    """Return a steering method that observes through an environment of its own as a contender.

    Args:
        env: steering task by which the method observes.
        method: steering method.
    """
    return lambda grounds, starts, steps: roll_out_cell(env, grounds, method, starts, steps)
