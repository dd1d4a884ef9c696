"""What a policy sees of a state (D table I)."""

import numpy as np

from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import PlanningState, bearing, lowest_foothold, rotate
from jaxleas.envs.gait_planning.reward import foot_offsets
from jaxleas.envs.gait_planning.signature import HIGHEST, heights_seen, heights_shape
from jaxleas.envs.gait_planning.supports import in_contact


def observation_of(
    config: GaitPlanningConfig, ground: Ground, state: PlanningState
) -> dict[str, np.ndarray]:
    """Return the parts of the observation, in physical units.

    Heights are those at points that turn with the base, above the lowest foothold.
    """
    phase, count = state.phase, len(state.step)
    points, _ = heights_seen(config)
    places = phase.com[:, None, :2] + rotate(phase.yaw, points[None].astype(np.float32))
    heights = ground.heights_at(state.field[:, None], places)
    heights = heights - lowest_foothold(phase.feet, phase.support)[:, None]
    return {
        "attitude": -bearing(phase, state.goal)[:, None],
        "velocity": rotate(-phase.yaw, phase.velocity),
        "feet": foot_offsets(config.robot, phase).reshape(count, -1),
        "contacts": 2.0 * in_contact(phase.support) - 1.0,
        "heights": heights.clip(-HIGHEST, HIGHEST).reshape(count, *heights_shape(config)),
    }
