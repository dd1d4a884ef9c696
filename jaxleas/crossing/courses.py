"""Courses that a quadruped crosses: stairs, gaps, stepping stones (Taouil's thesis, chapter 5)."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from jaxleas.crossing.course import Course, level_scene, stop_at
from jaxleas.crossing.obstacle_course import obstacle_course
from jaxleas.terrain import Area, Scene
from jaxleas.types import InputError

HALF_WIDTH = 1.0
"""Half width of a course [m]."""
RUN_UP = 1.0
"""Distance from the place of the start to the first edge [m], as in the thesis's logs."""
BEHIND = 0.8
"""Ground behind the place of the start, and beyond that of the goal [m]."""
BLOCK_HEIGHT = 0.18
"""Height of blocks above the ground between them [m] (thesis, section 5.2)."""
STEPS = 12
"""Number of steps up, and down (thesis, section 5.2)."""


def stairs(name: str, riser: float, tread: float) -> Course:
    """Return twelve steps up and twelve down, with a landing between.

    Args:
        name: name of the course.
        riser: height of a step [m].
        tread: depth of a step [m].
    """
    heights = [riser * step for step in range(1, STEPS + 1)]
    edges = [RUN_UP + tread * step for step in range(STEPS)]
    top = (edges[-1], edges[-1] + LANDING)
    flights = {"start": ((-BEHIND, RUN_UP), 0.0), "landing": (top, heights[-1])}
    for step, (edge, height) in enumerate(zip(edges[:-1], heights[:-1], strict=True)):
        begin = top[1] + tread * (STEPS - 2 - step)
        flights[f"up_{step}"] = ((edge, edge + tread), height)
        flights[f"down_{step}"] = ((begin, begin + tread), height)
    foot = top[1] + tread * (STEPS - 1)
    flights["goal"] = ((foot, foot + 2.0 * BEHIND), 0.0)
    return Course(name, _strips(flights), stop_at(foot + BEHIND))


LANDING = 1.0
"""Length of the landing between two stairs [m]."""


def low_and_high(name: str) -> Course:
    """Return a low plank, and two high steps up and two down, of which a low swing clears none.

    Args:
        name: name of the course.
    """
    heights = (0.0, LOW_RISER, 0.0, HIGH_RISER, 2.0 * HIGH_RISER, HIGH_RISER, 0.0)
    lengths = (BEHIND + RUN_UP, 0.8, 1.6, 1.0, LANDING, 1.0, 2.5 * BEHIND)
    ends = np.cumsum((-BEHIND, *lengths)).tolist()
    strips = {
        f"level_{number}": ((ends[number], ends[number + 1]), height)
        for number, height in enumerate(heights)
    }
    return Course(name, _strips(strips), stop_at(ends[-1] - BEHIND))


LOW_RISER, HIGH_RISER = 0.042, 0.08
"""Risers that swings of 6.5 cm clear, and that they do not [m]."""


def gaps(name: str, widths: Sequence[float], seed: int) -> Course:
    """Return blocks with gaps between them; the ground is 18 cm lower.

    Args:
        name: name of the course.
        widths: width of each gap [m].
        seed: seed of the lengths of the blocks between, 0.6 to 1.0 m.
    """
    lengths = np.random.default_rng(seed).uniform(*BLOCK_LENGTHS, len(widths) - 1)
    begin, blocks = RUN_UP, {"start": ((-BEHIND, RUN_UP), 0.0)}
    for number, (width, length) in enumerate(zip(widths, [*lengths, 2.0 * BEHIND], strict=True)):
        begin += width
        blocks[f"block_{number}"] = ((begin, begin + length), 0.0)
        begin += length
    blocks["ground"] = ((-BEHIND, begin), -BLOCK_HEIGHT)
    return Course(name, _strips(blocks), stop_at(begin - BEHIND))


BLOCK_LENGTHS = (0.6, 1.0)


def stones(name: str, seed: int) -> Course:
    """Return rows of stepping stones of 30 to 40 cm, 4 to 8 cm apart, over 3 m.

    Args:
        name: name of the course.
        seed: seed of sizes and places.
    """
    rng = np.random.default_rng(seed)
    far = RUN_UP + STONES_LONG
    surfaces: dict[str, tuple[Area, float]] = {
        "start": ((-BEHIND, RUN_UP, -HALF_WIDTH, HALF_WIDTH), 0.0)
    }
    begin = RUN_UP + rng.uniform(*STONE_GAPS)
    while begin < far:
        length = rng.uniform(*STONE_SIZES)
        across = -HALF_WIDTH - rng.uniform(0.0, STONE_SIZES[0])
        while across < HALF_WIDTH:
            width = rng.uniform(*STONE_SIZES)
            area = (begin, begin + length, across, across + width)
            surfaces[f"stone_{len(surfaces)}"] = (area, 0.0)
            across += width + rng.uniform(*STONE_GAPS)
        begin += length + rng.uniform(*STONE_GAPS)
    end = begin + 2.0 * BEHIND
    surfaces["goal"] = ((begin, end, -HALF_WIDTH, HALF_WIDTH), 0.0)
    low = (-BEHIND, end, -HALF_WIDTH - STONE_SIZES[1], HALF_WIDTH + STONE_SIZES[1])
    surfaces["ground"] = (low, -BLOCK_HEIGHT)
    return Course(name, level_scene(surfaces), stop_at(begin + BEHIND))


STONES_LONG, STONE_SIZES, STONE_GAPS = 3.0, (0.30, 0.40), (0.04, 0.08)


_THESIS_1 = (0.07, 0.075, 0.08, 0.085, 0.09)
_THESIS_2 = tuple(np.random.default_rng(0).uniform(0.015, 0.071, 14).tolist())
COURSES: Mapping[str, Callable[[], Course]] = MappingProxyType(
    {
        "stairs_1": lambda: stairs("stairs_1", 0.042, 1.0 / 3.0),
        "stairs_2": lambda: stairs("stairs_2", 0.042, 0.25),
        "stairs_3": lambda: stairs("stairs_3", 0.05, 0.20),
        "stairs_high": lambda: low_and_high("stairs_high"),
        "gaps_1": lambda: gaps("gaps_1", _THESIS_1, seed=1),
        "gaps_2": lambda: gaps("gaps_2", _THESIS_2, seed=2),
        "gaps_12cm": lambda: gaps("gaps_12cm", (0.12,) * 5, seed=3),
        "gaps_16cm": lambda: gaps("gaps_16cm", (0.16,) * 5, seed=4),
        "gaps_20cm": lambda: gaps("gaps_20cm", (0.20,) * 5, seed=5),
        "stones": lambda: stones("stones", seed=6),
        "waypoints": lambda: obstacle_course("waypoints"),
    }
)
"""Stairs are those of the thesis's scenarios 1.1 to 1.3. Of gaps it gives widths, not places,
and of its waypoint course a picture alone."""


def make_course(name: str) -> Course:
    """Return a course by its name.

    Raises:
        InputError: there is no such course.
    """
    if name not in COURSES:
        raise InputError(f"there is no course {name!r}, only {', '.join(COURSES)}")
    return COURSES[name]()


def _strips(strips: Mapping[str, tuple[tuple[float, float], float]]) -> Scene:
    """Return level strips across the course, each from one x to another at a height."""
    return level_scene(
        {
            name: ((begin, end, -HALF_WIDTH, HALF_WIDTH), height)
            for name, ((begin, end), height) in strips.items()
        }
    )
