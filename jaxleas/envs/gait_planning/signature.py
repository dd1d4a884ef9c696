"""The signature of gait planning: tables I of D, with mirrors."""

import math
from typing import Any

from jaxleas.envs import Cases, Categorical, Interval, Mirror, Normal, Part, Signature
from jaxleas.envs.gait_planning.actions import largest_offset
from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.layout import MAP_SIDE, HeightPoints, light_points, map_points
from jaxleas.envs.gait_planning.quadruped import FEET
from jaxleas.envs.gait_planning.supports import CODE_MIRROR, CODE_SIZE, MIRRORED, STANDING, SUPPORTS

HIGHEST = 0.5
"""Height above and below the lowest foothold to which heights are clipped [m]."""
SEEN_HEIGHT, SEEN_FOOT, SEEN_SPEED = 0.15, 0.2, 0.5
"""What networks see as 1: heights [m], offsets of feet [m], velocities [m/s]."""
VECTOR = Mirror.of_signs([1.0, -1.0])
PHASE = "phase"
SWAPPED = (1, 0, 3, 2)
"""Foot that each foot becomes when left and right are swapped."""
FEET_MIRROR = Mirror(
    tuple(2 * foot + axis for foot in SWAPPED for axis in (0, 1)), (1.0, -1.0) * len(FEET)
)


def heights_seen(config: GaitPlanningConfig) -> HeightPoints:
    """Return the points whose heights a policy sees."""
    if config.observation == "published":
        return map_points()
    return light_points(config.robot.nominal_ahead, config.robot.nominal_aside)


def heights_shape(config: GaitPlanningConfig) -> tuple[int, ...]:
    """Return the shape in which a policy sees heights: a vector, or a map."""
    is_map = config.observation == "published"
    return (MAP_SIDE, MAP_SIDE) if is_map else (len(heights_seen(config).points),)


def signature_of(config: GaitPlanningConfig) -> Signature:
    """Return the signature of a configuration (D table I)."""
    mirror = heights_seen(config).mirror
    parts = (
        Part("attitude", (1,), deviation=math.pi, mirror=Mirror.of_signs([-1.0])),
        Part("velocity", (2,), deviation=SEEN_SPEED, mirror=VECTOR),
        Part("feet", (2 * len(FEET),), deviation=SEEN_FOOT, mirror=FEET_MIRROR),
        Part("contacts", (len(FEET),), mirror=Mirror(SWAPPED, (1.0,) * len(FEET))),
        Part("heights", heights_shape(config), deviation=SEEN_HEIGHT, mirror=mirror),
    )
    scales, feet = config.action, largest_offset(config)
    numbers = [
        (Interval(-scales.turn, scales.turn), Mirror.of_signs([-1.0])),
        (Interval(-scales.step, scales.step, 2), VECTOR),
        (Interval(-scales.speed, scales.speed, 2), VECTOR),
        (Interval(-feet, feet, 2 * len(FEET)), FEET_MIRROR),
        (
            Interval(scales.middle_time - scales.time, scales.middle_time + scales.time, 2),
            Mirror.of_signs([1.0, 1.0]),
        ),
    ]
    if config.contact_code == "five_way":
        choice = Categorical("support", SUPPORTS, MIRRORED)
        return Signature(parts, (Cases(PHASE, choice, _normal(config, numbers)),))
    code = (Interval(-1.0, 1.0, CODE_SIZE), Mirror.of_signs(CODE_MIRROR))
    return Signature(parts, (_normal(config, [*numbers, code]),))


def _normal(config: GaitPlanningConfig, numbers: list[tuple[Interval, Mirror]]) -> Normal:
    return Normal(
        PHASE,
        tuple(scale for scale, _ in numbers),
        Mirror.join([mirror for _, mirror in numbers]),
        gain=config.action_gain,
    )


def description_of(config: GaitPlanningConfig) -> dict[str, Any]:
    """Return what the parts and the command mean, as plain JSON values."""
    return {
        "feet": list(FEET),
        "supports": STANDING.tolist(),
        "height_points": heights_seen(config).points.tolist(),
        "height_range": [-HIGHEST, HIGHEST],
        "phase": ["turn", "step (2)", "velocity (2)", "feet (4 x 2)", "t_E*, t_S", "support"],
        "placing": config.placing,
    }
