"""Places that the robot can stand on and neither leave nor reach: spikes, pits, islands, cages."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.ndimage import label

from jaxleas.guide.places import HEADINGS, Places, on_host
from jaxleas.types import InputError, is_ground

HALF = 8
"""Cells from the middle of the square that is searched to its edge."""
DEEP = 16
"""Levels above and below the first root that are searched."""
CELL, LEVEL = 0.1, 0.08  # edges of the cells of the search: along the ground, and upwards [m]
EVEN = 0.2  # ground that rises and falls by less than this cuts nothing off [m]
LENIENT = -0.02  # conditions that fail by less than this may hold between two cells [m]


@dataclass(frozen=True, eq=False)
class Around:
    """The surroundings of a place: a square of cells with the place in its middle.

    Attributes:
        at: x and y of the cells [m].
        ground: heights of the ground [m], NaN where there is none.
        reached: cells that the robot may get to from the middle without leaving the square.
        apart: cells where it may be at heights that it does not get to from the middle.
    """

    at: Float[np.ndarray, "R C 2"]
    ground: Float[np.ndarray, "R C"]
    reached: Bool[np.ndarray, "R C"]
    apart: Bool[np.ndarray, "R C"]

    @property
    def leads_out(self) -> bool:
        """Whether a cell at the edge of the square may be reached."""
        inner = self.reached[1:-1, 1:-1]
        return bool(self.reached.sum() > inner.sum())

    def describe(self) -> str:
        """Return what cuts the place off, as the end of a sentence."""
        here = self.ground[HALF, HALF]
        others = self.ground[~self.reached]
        around = others[np.isfinite(others)]
        if len(around) < 0.5 * others.size:
            return "on an island with no ground around it"
        higher = here - float(np.median(around))
        if abs(higher) < EVEN:
            return "closed in by what is around it"
        if higher > 0.0:
            return f"on a spike {higher:.2f} m above the ground around it"
        return f"in a pit {-higher:.2f} m below the ground around it"


def require_not_cut_off(
    places: Places, start: tuple[float, float], goal: tuple[float, float]
) -> None:
    """Require that ways may lead away from a start, and to a goal.

    Only what is certain is refused: the search allows every heading and height at every place.

    Args:
        places: places of the terrain where the robot can stand.
        start: start x, y [m], where the robot can stand.
        goal: goal x, y [m], where the robot can stand.

    Raises:
        InputError: the start or the goal is cut off; the message says by what.
    """
    radius = places.env.config.goal_radius
    here = look_around(places, start)
    if here is not None and not here.leads_out and not _near(here.at[here.reached], goal, radius):
        raise InputError(
            f"--from {start[0]:g},{start[1]:g}: the robot stands {here.describe()}, and no way"
            f" leads off{_hint(places, here, start)}"
        )
    there = look_around(places, goal)
    if there is None or there.leads_out or _near(there.at[there.reached], start, 0.0):
        return
    if not _near(there.at[there.apart], goal, radius):  # close enough from elsewhere
        raise InputError(
            f"--to {goal[0]:g},{goal[1]:g}: the goal lies {there.describe()}, and no way leads"
            f" there{_hint(places, there, goal)}"
        )


def look_around(places: Places, place: tuple[float, float]) -> Around | None:
    """Return where the robot may get to from a place; None for even ground, where it is plain.

    Args:
        places: places of the terrain where the robot can stand.
        place: x, y [m], where the robot can stand.
    """
    steps = CELL * np.arange(-HALF, HALF + 1)
    at = np.stack(np.meshgrid(place[0] + steps, place[1] + steps), axis=-1)
    heights = places.terrain.height_at(at.reshape(-1, 2)).astype(np.float64)
    ground = np.where(is_ground(heights), heights, np.nan).reshape(at.shape[:2])
    if np.isfinite(ground).all() and np.ptp(ground) < EVEN:
        return None
    root = float(ground[HALF, HALF]) + places.env.robot.walking_height
    around = Around(at, ground, *_joined(_standing_levels(places, at, root)))
    if around.leads_out:  # most places: the slower search is not needed
        return around
    return Around(at, ground, *_joined(_valid_levels(places, at, root)))


def _near(at: Float[np.ndarray, "N 2"], place: tuple[float, float], radius: float) -> bool:
    """Return whether a cell lies within a radius [m] of a place, or may do so."""
    away = np.linalg.norm(at - place, axis=-1)
    return bool((away <= radius + 0.5 * CELL).any())


def _joined(
    valid: Bool[np.ndarray, "R C L"],
) -> tuple[Bool[np.ndarray, "R C"], Bool[np.ndarray, "R C"]]:
    """Return the cells that steps to neighbouring valid places reach, and those of the others."""
    valid[HALF, HALF, DEEP] = True  # as is known; perhaps with a heading that is not searched
    regions = np.zeros(valid.shape, np.int32)
    label(valid, structure=np.ones((3, 3, 3)), output=regions)
    mine = regions == regions[HALF, HALF, DEEP]
    return mine.any(axis=2), (valid & ~mine).any(axis=2)


def _standing_levels(
    places: Places, at: Float[np.ndarray, "R C 2"], root: float
) -> Bool[np.ndarray, "R C L"]:
    """Return the heights of roots that stand over each cell, and those a level from them."""
    cells = at.reshape(-1, 2)
    standing = places.valid_anyhow(cells)
    level = np.full(len(cells), -2)  # beyond all levels
    above = (places.root_height(cells[standing]) - root) / LEVEL
    level[standing] = DEEP + np.round(np.clip(above, -2 * DEEP, 2 * DEEP)).astype(int)
    levels = np.abs(np.arange(2 * DEEP + 1) - level[:, None]) <= 1
    return levels.reshape(*at.shape[:2], -1)


def _valid_levels(
    places: Places, at: Float[np.ndarray, "R C 2"], root: float
) -> Bool[np.ndarray, "R C L"]:
    """Return at which heights about a root's the conditions may hold over each cell."""
    levels = root + LEVEL * np.arange(-DEEP, DEEP + 1)
    shape = (*at.shape[:2], len(levels), len(HEADINGS))
    position = np.empty((*shape, 3), np.float32)
    position[..., :2], position[..., 2] = at[:, :, None, None], levels[None, None, :, None]
    yaw = np.broadcast_to(HEADINGS.astype(np.float32), shape)
    flat = position.reshape(-1, 3)
    motion = on_host(flat, np.zeros_like(flat), yaw.reshape(-1))
    margin = places.margins_of(motion)["the condition"].reshape(shape)
    return np.logical_or.reduce(margin >= LENIENT, axis=-1)


def _hint(places: Places, around: Around, place: tuple[float, float]) -> str:
    """Return the nearest place that is not cut off in the same way, as the end of a sentence."""
    others = around.at[~around.reached]
    standing = others[places.valid_anyhow(others)]
    if not len(standing):
        return ""
    x, y = standing[np.argmin(np.linalg.norm(standing - place, axis=1))]
    return f"; the nearest place apart from it is {x:.2f},{y:.2f}"
