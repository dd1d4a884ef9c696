"""Lessons: drawn courses on which a planner's choices are asked for."""

from dataclasses import dataclass, replace

import numpy as np

from jaxleas.crossing.course import STOPS, Course, level_scene, stop_at
from jaxleas.crossing.courses import gaps, stones
from jaxleas.footsteps import Goal

KINDS = ("stairs", "gaps", "gaps", "stairs", "blocks")
"""Kinds of terrain, which follow each other; stones take the place of every fourth blocks."""
RISERS, TREADS, STEPS = (0.03, 0.055), (0.18, 0.38), (3, 7)
"""Risers and treads of stairs [m]; least number of steps, and the one after the largest."""
GAPS, MOST_GAPS = (0.015, 0.17), 8
"""Widths of gaps [m], and the largest number of them."""
BACK = 0.3
"""Share of lessons in which the robot goes back to where it came from."""


@dataclass(frozen=True, eq=False)
class Lesson:
    """A course that was drawn for a number.

    Attributes:
        number: number of the lesson.
        course: terrain, and a way across it.
        more: poses to reach in turn after the course's goal.
    """

    number: int
    course: Course
    more: tuple[Goal, ...] = ()

    @property
    def goals(self) -> tuple[Goal, ...]:
        """All poses to reach, in turn."""
        return (*self.course.goals, *self.more)


def make_lesson(number: int) -> Lesson:
    """Return the lesson of a number; none is a course that robots are judged on.

    Args:
        number: number of the lesson, which is its seed, too.
    """
    rng = np.random.default_rng((SEED, number))
    kind = KINDS[number % len(KINDS)]
    name = f"{kind}_{number}"
    if kind == "stairs":
        course = _stairs(name, rng, is_even=number // len(KINDS) % 2 == 0)
    elif kind == "gaps":
        count = int(rng.integers(3, MOST_GAPS + 1))
        least = rng.uniform(*GAPS)
        widths = rng.uniform(least, rng.uniform(least, GAPS[1]), count)
        course = gaps(name, widths.tolist(), int(rng.integers(1_000, 1_000_000)))
    elif number // len(KINDS) % 4 == 3:
        course = stones(name, int(rng.integers(1_000, 1_000_000)))
    else:
        return Lesson(number, *_blocks(name, rng))
    if kind != "blocks" and rng.uniform() < BACK:
        return Lesson(number, course, (replace(stop_at(0.0), yaw=float(np.pi)),))
    return Lesson(number, course)


SEED = 170_000
"""Seed of all lessons."""


def _stairs(name: str, rng: np.random.Generator, is_even: bool) -> Course:
    """Return a few steps up and down: all of a staircase in less time than a whole one takes.

    Args:
        name: name of the course.
        rng: source of all sizes.
        is_even: whether all steps are alike: where they are not, a lesson has more of them.
    """
    riser, tread = rng.uniform(*RISERS), rng.uniform(*TREADS)
    steps, half = int(rng.integers(*STEPS)), 1.0
    heights = riser * np.array([*range(steps), *range(steps, -1, -1)])
    widths = np.full(2 * steps + 1, tread)
    widths[[0, steps, -1]] = 1.8, rng.uniform(0.6, 1.2), 1.6
    if not is_even:
        widths[1:steps] = rng.uniform(*TREADS, steps - 1)
        widths[steps + 1 : -1] = rng.uniform(*TREADS, steps - 1)
        rises = rng.uniform(*RISERS, 2 * steps) * np.repeat([1.0, -1.0], steps)
        heights = np.concatenate([[0.0], np.cumsum(rises)])
    edges = np.concatenate([[0.0], np.cumsum(widths)]) - 0.8
    surfaces = {
        f"step_{number}": ((begin, end, -half, half), float(height))
        for number, (begin, end, height) in enumerate(
            zip(edges[:-1], edges[1:], heights, strict=True)
        )
    }
    return Course(name, level_scene(surfaces), stop_at(float(edges[-1]) - 0.8))


def _blocks(name: str, rng: np.random.Generator) -> tuple[Course, tuple[Goal, ...]]:
    """Return low blocks scattered over level ground, and goals with any heading among them."""
    half = 2.5
    surfaces = {"ground": ((-1.0, 2 * half, -half, half), 0.0)}
    for number in range(int(rng.integers(0, 14))):
        x, y = rng.uniform(0.8, 2 * half - 1.0), rng.uniform(-half + 0.8, half - 0.8)
        long, wide = rng.uniform(0.15, 0.6, 2)
        area = (x, x + long, y - wide, y + wide)
        surfaces[f"block_{number}"] = (area, rng.uniform(0.03, 0.06))
    goals = [
        Goal(*rng.uniform((0.0, -half + 0.8), (2 * half - 1.0, half - 0.8)), speed=STOPS)
        for _ in range(3)
    ]
    first, *more = [replace(each, yaw=float(rng.uniform(-np.pi, np.pi))) for each in goals]
    return Course(name, level_scene(surfaces), first), tuple(more)
