"""Planning with and without a guide, by path length (T table 5.1).

The course is our own terrain, similar to T figure 5.4: rubble, a bridge and three stairs in a row,
crossed along its middle in 94 steps of 22 cm; the shorter paths are its first steps.
"""

from collections.abc import Iterator

import numpy as np

from benchmarks.contacts.rows import Row, milliseconds
from jaxleas.contacts import ContactProblem, Stepping, plan_mip, problem_from_guide
from jaxleas.terrain import Scene, transition
from jaxleas.types import GuidePath

KINDS = ("rubble", "bridge", "stairs_up", "stairs_down", "stairs_up")
LENGTHS = (18, 36, 56, 74, 94)  # steps
THESIS_WITH = (30, 75, 120, 218, 292)  # [ms], Gurobi
THESIS_WITHOUT = (330, 3400, 4700, 27200, 31000)
LIMITS = {18: 60.0, 94: 1000.0}  # [ms], this project's own targets
ABOVE_GROUND, BEGIN, LENGTH = 0.95, 0.5, 20.5  # [m]


def long_course(seed: int = 0) -> tuple[Scene, np.ndarray]:
    """Return 22 m of terrain, and the roots [95, 3] of a guide along its middle."""
    surfaces, shift, profile = {}, np.zeros(3), [(-2.0, 0.0)]
    for index, kind in enumerate(KINDS):
        scene = transition(kind, seed + index).scene
        parts = list(scene.surfaces.items())
        if index:  # its first tile is the last one of the terrain before
            parts = parts[1:]
        for name, vertices in parts:
            surfaces[f"{index}_{name}"] = vertices + shift
        rise = float(list(scene.surfaces.values())[-1][0, 2])
        x, z = shift[0], shift[2]
        profile += [(x + 2.0, z), (x + 4.0, z + rise)]
        shift = shift + np.array([4.0, 0.0, rise])
    along = BEGIN + LENGTH * np.linspace(0.0, 1.0, max(LENGTHS) + 1)
    height = np.interp(along, *np.array(profile).T)
    return Scene(surfaces), np.stack([along, 0.0 * along, height + ABOVE_GROUND], axis=1)


def course_problem(scene: Scene, roots: np.ndarray, steps: int) -> ContactProblem:
    """Return the problem of the first steps of the course."""
    position = roots[: steps + 1]
    still = np.zeros(len(position))
    guide = GuidePath(still, position, still, np.zeros_like(position), still == 0.0)
    return problem_from_guide(guide, scene, "talos", Stepping(every=1))


def with_and_without_guide(patience: float) -> Iterator[Row]:
    """Plan each length with a guide, five times, and without, once and for at most `patience` [s].

    The value is null if there was no answer in that time.
    """
    scene, roots = long_course()
    for steps, ours, theirs in zip(LENGTHS, THESIS_WITH, THESIS_WITHOUT, strict=True):
        asked = course_problem(scene, roots, steps)
        times, plan = milliseconds(lambda p=asked: plan_mip(p, diagnose=False), 5)
        name = f"contacts_course_{steps}_steps"
        yield Row(
            f"{name}_with_guide", "ms", times if plan.feasible else [None] * 5, ours,
            LIMITS.get(steps),
        )  # fmt: skip
        free = asked.without_guide()
        times, plan = milliseconds(
            lambda p=free: plan_mip(p, diagnose=False, time_limit=patience), 1
        )
        yield Row(f"{name}_without_guide", "ms", times if plan.feasible else [None], theirs)
