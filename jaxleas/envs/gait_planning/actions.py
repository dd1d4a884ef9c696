"""What an action means in physical units (D table I), and which action means a command."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import Phases, PlanningState, rotate
from jaxleas.envs.gait_planning.supports import decode, in_contact


class Command(NamedTuple):
    """A proposed phase in physical units, whatever an action places first.

    Attributes:
        turn: turn of the base [rad].
        step: motion of the base in its present frame [m].
        velocity: velocity of the base in its next frame [m/s].
        feet: offsets of the feet from their nominal places, in the base's next frame [m].
        times: duration of the next phase before its own transition, t_E*, and of the present phase
            from now on, t_S [s].
        support: number of the next support.
    """

    turn: Float[np.ndarray, " N"]
    step: Float[np.ndarray, "N 2"]
    velocity: Float[np.ndarray, "N 2"]
    feet: Float[np.ndarray, "N 4 2"]
    times: Float[np.ndarray, "N 2"]
    support: np.ndarray


def largest_offset(config: GaitPlanningConfig) -> float:
    """Return the largest offset of a foot from its nominal place that an action names [m].

    About the present base a foot lies as much farther as the base moves.
    """
    scales = config.action
    return scales.foot + (scales.step if config.placing == "feet_first" else 0.0)


def command_of(
    config: GaitPlanningConfig,
    ground: Ground,
    state: PlanningState,
    action: Float[np.ndarray, "N size"],
) -> Command:
    """Return the command of an action whose numbers lie in [-1, 1].

    Args:
        config: configuration of the task.
        ground: ground.
        state: states that the action is taken in.
        action: numbers of table I, and the index of the support, or the code of one.
    """
    scales = config.action
    numbers = np.asarray(action, np.float64)
    turn, step, velocity, feet, times, code = np.split(numbers, (1, 3, 5, 13, 15), axis=1)
    by_index = config.contact_code == "five_way"
    command = Command(
        scales.turn * turn[:, 0],
        scales.step * step,
        scales.speed * velocity,
        largest_offset(config) * feet.reshape(-1, 4, 2),
        scales.middle_time + scales.time * times,
        code[:, 0].astype(np.int64) if by_index else decode(code),
    )
    if config.placing == "base_first":
        return command
    return _about_the_feet(config, ground, state, command)


def action_of(
    config: GaitPlanningConfig, state: PlanningState, command: Command, after: Phases
) -> Float[np.ndarray, "N 16"]:
    """Return the actions, cut at the ends of their ranges, whose commands these are.

    Args:
        config: configuration of the task, whose contact code is five_way.
        state: states that the commands are given in.
        command: commands.
        after: phases that they lead to.
    """
    scales, now = config.action, state.phase
    step, feet = command.step, command.feet
    if config.placing == "feet_first":
        places = after.feet[..., :2]
        middle = _middle_of(places, command.support)
        step = rotate(-after.yaw, after.com[:, :2] - middle)
        feet = rotate(-now.yaw, places - now.com[:, None, :2]) - config.robot.nominal[:, :2]
    numbers = (
        command.turn[:, None] / scales.turn,
        step / scales.step,
        command.velocity / scales.speed,
        feet.reshape(len(command.turn), -1) / largest_offset(config),
        (command.times - scales.middle_time) / scales.time,
    )
    cut = np.concatenate(numbers, axis=1).clip(-1.0, 1.0)
    return np.concatenate([cut, np.asarray(command.support)[:, None]], axis=1)


def _about_the_feet(
    config: GaitPlanningConfig, ground: Ground, state: PlanningState, command: Command
) -> Command:
    """Return the command whose step is about the mean of the feet in contact, as one of the base.

    The feet that it places anew are about the present base.
    """
    now, nominal = state.phase, config.robot.nominal[:, :2]
    proposed = now.com[:, None, :2] + rotate(now.yaw, nominal + command.feet)
    feet = ground.snapped(state.field[:, None], proposed, config.snap)
    stays = in_contact(now.support) & in_contact(command.support)
    feet = np.where(stays[..., None], now.feet[..., :2], feet)
    yaw = now.yaw + command.turn
    base = _middle_of(feet, command.support) + rotate(yaw, command.step)
    return command._replace(
        step=rotate(-now.yaw, base - now.com[:, :2]),
        feet=rotate(-yaw, feet - base[:, None]) - nominal,
    )


def _middle_of(feet: Float[np.ndarray, "N 4 2"], support: np.ndarray) -> Float[np.ndarray, "N 2"]:
    """Return the mean of the feet in contact."""
    standing = in_contact(support)[..., None]
    return (feet * standing).sum(axis=1) / standing.sum(axis=1)
