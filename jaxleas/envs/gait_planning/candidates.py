"""The phase that a command proposes."""

import numpy as np

from jaxleas.envs.gait_planning.actions import Command
from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import Phases, PlanningState, lowest_foothold, rotate
from jaxleas.envs.gait_planning.supports import in_contact
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.types import is_ground


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
