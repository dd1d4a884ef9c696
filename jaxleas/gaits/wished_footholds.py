"""Where each foot had best stand next: near its nominal place, ahead, and far from edges."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    Ground,
    PlanningState,
    bearing,
    edge_distance,
    lowest_foothold,
    rotate,
)
from jaxleas.gaits.crawl_settings import CrawlSettings
from jaxleas.terrain import HeightMap
from jaxleas.types import is_ground

OFFSETS = np.stack(
    np.meshgrid(np.arange(-7, 8) * 0.03, np.arange(-3, 4) * 0.03, indexing="ij"), axis=-1
).reshape(-1, 2)
"""Offsets of the footholds that are tried from the nominal place, ahead and to the left [m]."""
ASIDE, CLEAR = 0.7, 1.5
"""Price of an offset to the side, and of a missing distance from edges, against one ahead."""
FAR_FROM_EDGES = 0.09
"""Distance from edges beyond which more is no better [m]."""
HIGHEST_STEP = 0.2
"""Height above or below the lowest foothold beyond which no foothold is wished [m]."""


class Footing(NamedTuple):
    """The ground of some fields, and how far each cell is from the edges.

    Attributes:
        ground: ground of the fields.
        distance: distance of each cell from the nearest edge [m].
    """

    ground: Ground
    distance: Float[np.ndarray, "fields rows columns"]


class Wishes(NamedTuple):
    """The wished foothold of each foot.

    Attributes:
        place: x and y of the foothold [m].
        possible: whether there is a safe one.
        gain: distance of the foot from it [m].
    """

    place: Float[np.ndarray, "N 4 2"]
    possible: Bool[np.ndarray, "N 4"]
    gain: Float[np.ndarray, "N 4"]


def footing_of(config: GaitPlanningConfig, ground: Ground) -> Footing:
    """Return the ground with the distances from its edges."""
    fields = (
        HeightMap(
            np.where(is_ground(heights), heights, np.nan).astype(np.float32),
            ground.resolution,
            (0.0, 0.0),
        )
        for heights in ground.heights
    )
    return Footing(ground, np.stack([edge_distance(config, field) for field in fields]))


def walking_share(state: PlanningState) -> Float[np.ndarray, " N"]:
    """Return 1 where the goal is ahead, 0 where the robot had better turn first."""
    return np.clip((np.cos(bearing(state.phase, state.goal)) - 0.3) / 0.5, 0.0, 1.0)


def wish_footholds(
    config: GaitPlanningConfig, footing: Footing, settings: CrawlSettings, state: PlanningState
) -> Wishes:
    """Return the best safe foothold of each foot among those around its nominal place.

    Args:
        config: configuration of the task.
        footing: ground.
        settings: settings of the search.
        state: states of robots.
    """
    phase, share = state.phase, walking_share(state)
    turn = np.clip(bearing(phase, state.goal), -settings.turn, settings.turn)
    ahead = np.stack([settings.advance * share, np.zeros_like(share)], axis=1)
    base = phase.com[:, :2] + rotate(phase.yaw, ahead)
    nominal = config.robot.nominal[:, None, :2] + OFFSETS
    places = base[:, None, None] + rotate(phase.yaw + turn, nominal[None])
    field = state.field[:, None, None]
    distance = footing.ground.looked_up(footing.distance, field, places)
    lowest = lowest_foothold(phase.feet, phase.support)[:, None, None]
    rise = np.abs(footing.ground.heights_at(field, places) - lowest)
    lengthwise = np.abs(OFFSETS[:, 0] - settings.lead * share[:, None])[:, None]
    price = lengthwise + ASIDE * np.abs(OFFSETS[:, 1])
    price = price - CLEAR * np.minimum(distance, FAR_FROM_EDGES)
    safe = (distance >= config.foot_clearance) & (rise <= HIGHEST_STEP)
    best = np.where(safe, price, np.inf).argmin(axis=2)[..., None]
    place = np.take_along_axis(places, best[..., None], axis=2)[:, :, 0]
    possible = np.take_along_axis(safe, best, axis=2)[..., 0]
    return Wishes(place, possible, np.linalg.norm(place - phase.feet[..., :2], axis=-1))
