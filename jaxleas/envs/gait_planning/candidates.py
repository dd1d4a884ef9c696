"""From an action to the phase that it proposes (D table I)."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import Phases, PlanningState, lowest_foothold, rotate
from jaxleas.envs.gait_planning.supports import decode, in_contact
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.types import is_ground


class Command(NamedTuple):
    """An action in physical units.

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


def command_of(config: GaitPlanningConfig, action: Any) -> Command:
    """Return the command of an action whose numbers lie in [-1, 1].

    Args:
        config: configuration of the task.
        action: action by head, or that of the only head alone.
    """
    scales, five_way = config.action, config.contact_code == "five_way"
    numbers = np.asarray(action["phase"] if five_way else action, np.float64)
    turn, step, velocity, feet, times, code = np.split(numbers, (1, 3, 5, 13, 15), axis=1)
    return Command(
        scales.turn * turn[:, 0],
        scales.step * step,
        scales.speed * velocity,
        scales.foot * feet.reshape(-1, 4, 2),
        scales.middle_time + scales.time * times,
        np.asarray(action["support"]) if five_way else decode(code),
    )


def action_of(config: GaitPlanningConfig, command: Command) -> dict[str, np.ndarray]:
    """Return the action by head, cut at the ends of its ranges, whose command this is.

    Args:
        config: configuration of the task, whose contact code is five_way.
        command: commands in physical units.
    """
    scales = config.action
    numbers = (
        command.turn[:, None] / scales.turn,
        command.step / scales.step,
        command.velocity / scales.speed,
        command.feet.reshape(len(command.turn), -1) / scales.foot,
        (command.times - scales.middle_time) / scales.time,
    )
    return {
        "phase": np.concatenate(numbers, axis=1).clip(-1.0, 1.0),
        "support": np.asarray(command.support),
    }


def candidate_of(
    config: GaitPlanningConfig, ground: Ground, state: PlanningState, command: Command
) -> Phases:
    """Return the phases that commands propose: heights are the ground's, standing feet stay."""
    now = state.phase
    yaw = wrap_angle_on_host(now.yaw + command.turn)
    place = now.com[:, :2] + rotate(now.yaw, command.step)
    nominal = config.robot.nominal[:, :2] + command.feet
    feet = np.empty(now.feet.shape)
    proposed = place[:, None] + rotate(yaw, nominal)
    feet[..., :2] = ground.snapped(state.field[:, None], proposed, config.snap)
    feet[..., 2] = ground.heights_at(state.field[:, None], feet[..., :2])
    stays = in_contact(now.support) & in_contact(command.support)
    feet = np.where(stays[..., None], now.feet, feet)
    lowest = lowest_foothold(feet, command.support)
    # A swinging foot may be over an abyss; then it is kept at the height of the lowest foothold.
    over = is_ground(feet[..., 2])
    feet[..., 2] = np.where(over, feet[..., 2], lowest[:, None])
    com = np.concatenate([place, (lowest + config.robot.com_height)[:, None]], axis=1)
    return Phases(
        com=com.astype(np.float32),
        yaw=yaw.astype(np.float32),
        velocity=rotate(yaw, command.velocity).astype(np.float32),
        feet=feet.astype(np.float32),
        support=command.support.astype(np.int32),
    )
