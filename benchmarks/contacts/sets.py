"""The search over sets of places without a guide, and the mixed-integer program beside it.

24 problems: twelve ways over our own courses of rubble, a bridge and stairs, in both models, with
every whole surface allowed in every step but the last. Six ways as they are; three in which a foot
moves twice at two places; two without a bridge's middle, and one with too few steps, which have no
plan.
"""

import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from benchmarks.contacts.course import course_problem, long_course
from benchmarks.contacts.rows import Row, milliseconds
from jaxleas.contacts import (
    ContactPlan,
    ContactProblem,
    certify_infeasible,
    plan_astar,
    plan_mip,
)

MODELS = ("two_com", "feet")
SEED = 4000  # of the courses that are judged; 0, 100 and 200 served the development
LEAST_SURFACES = 25
LIMIT = 125.0  # [ms], this project's own target
RUNS = 3
FAR = 80  # steps of the way that is to be made in 36
HOLE = (6.3, 7.4)  # x of the bridge's middle [m]


def problems(seed: int = SEED) -> Iterator[tuple[str, ContactProblem]]:
    """Yield a name and a problem."""
    for index, steps in enumerate((30, 32, 33, 34, 35, 36)):
        yield from _both(f"way_{steps}", _way(seed + 10 * index, steps))
    for index, steps in enumerate((32, 34, 36)):
        yield from _both(f"twice_{steps}", _twice(_way(seed + 60 + 10 * index, steps)))
    for index, steps in enumerate((34, 36)):
        yield from _both(f"hole_{steps}", _with_hole(_way(seed + 90 + 10 * index, steps)))
    yield from _both("far_36", _too_far(_way(seed + 110, FAR), 36))


def without_guide(patience: float) -> Iterator[Row]:
    """Plan each problem three times by the search, and once by the program for `patience` [s].

    A problem that the program does not decide in that time counts with it.
    """
    for _, asked in problems(0):
        plan_astar(asked, diagnose=False)  # what the first call alone costs
        break
    ours, spent, theirs, held = [], [], [], []
    for name, asked in problems():
        assert 30 <= len(asked) <= 36
        assert len(asked.whole_surfaces) >= LEAST_SURFACES
        begun = time.process_time()
        times, plan = milliseconds(lambda p=asked: plan_astar(p, diagnose=False), RUNS)
        spent.append(1000.0 * (time.process_time() - begun) / RUNS)
        ours.append(float(np.median(times)))
        times, other = milliseconds(
            lambda p=asked: plan_mip(p, diagnose=False, time_limit=patience), 1
        )
        theirs.append(times[0])
        if plan.proof is not None:
            held.append(100.0 * certify_infeasible(asked, plan.proof).holds)
        _tell(name, asked, plan, other, (ours[-1], theirs[-1]))
    least, median = "astar_36_steps_without_guide", float(np.median(theirs))
    yield Row(f"{least}_median", "ms", ours, median, LIMIT)
    yield Row(f"{least}_processor_median", "ms", spent)
    yield Row(f"{least}_worst", "ms", [max(ours)], max(theirs))
    yield Row("mip_36_steps_without_guide_median", "ms", theirs)
    yield Row("astar_36_steps_proofs_held", "%", [float(np.mean(held))], None, 100.0, "higher")


def _tell(
    name: str,
    asked: ContactProblem,
    plan: ContactPlan,
    other: ContactPlan,
    times: tuple[float, float],
) -> None:
    statuses = f"{plan.status}, mip {other.status}"
    if other.status != "time_limit" and plan.status != other.status:
        raise AssertionError(f"{name}: {statuses}")
    print(
        f"{name} {asked.model}: {len(asked)} steps, {len(asked.whole_surfaces)} surfaces:"
        f" {statuses}, {times[0]:.0f} and {times[1]:.0f} ms",
        flush=True,
    )


def _both(name: str, asked: ContactProblem) -> Iterator[tuple[str, ContactProblem]]:
    for model in MODELS:
        yield name, replace(asked, model=model)


def _way(seed: int, steps: int) -> ContactProblem:
    scene, roots = long_course(seed)
    return course_problem(scene, roots, steps).without_guide()


def _twice(asked: ContactProblem) -> ContactProblem:
    """Let a foot move twice after a third and after two thirds of the steps."""
    feet, steps = asked.effectors, []
    for index, step in enumerate(asked.steps):
        turn = index - (index > len(asked) // 3) - (index > 2 * len(asked) // 3)
        first = feet.index(asked.steps[0].foot)
        steps.append(replace(step, foot=feet[(first + turn) % 2]))
    return replace(asked, steps=tuple(steps))


def _with_hole(asked: ContactProblem) -> ContactProblem:
    """Take the surfaces away whose middle is over the hole."""
    middles = {name: each.vertices[:, 0].mean() for name, each in asked.surfaces.items()}
    gone = {name for name, x in middles.items() if HOLE[0] < x < HOLE[1]}
    surfaces = {name: each for name, each in asked.surfaces.items() if name not in gone}
    parts = {part: whole for part, whole in asked.parts.items() if not {part, whole} & gone}
    left = {part for part, whole in asked.parts.items() if whole in gone}
    surfaces = {name: each for name, each in surfaces.items() if name not in left}
    steps = [
        replace(step, candidates=tuple(name for name in step.candidates if name in surfaces))
        for step in asked.steps
    ]
    return replace(asked, surfaces=surfaces, parts=parts, steps=tuple(steps))


def _too_far(asked: ContactProblem, steps: int) -> ContactProblem:
    """Ask for the goal of a longer way."""
    goal = asked.steps[-1].candidates
    kept = asked.steps[:steps]
    return replace(asked, steps=(*kept[:-1], replace(kept[-1], candidates=goal)))
