"""The sampling-based planner against the number of samples and the step length (T figure 4.5).

On stairs up, as in T 4.1.4, but with straight guides at a steady speed instead of RB-Kino's: from
uniform starts at the bottom to the top, at walking height over the slope of the stairs. Success is
the share of a guide that is reached; the time is that of completely reached guides, one by one.
"""

from collections.abc import Iterator

import numpy as np

from benchmarks.contacts.rows import Row
from jaxleas.contacts import SamplingSettings, plan_contacts
from jaxleas.robots import load_robot
from jaxleas.terrain import Scene, transition
from jaxleas.types import GuidePath

TALOS = load_robot("talos")

SAMPLES = (1_000, 2_500, 5_000, 10_000, 25_000, 50_000)
KEPT = (1, 3, 5, 7, 10)  # configurations, 2 cm apart, from one kept to the next
FINE = 5  # while the number of samples varies: 10 cm
TERRAIN_SEEDS = (1_700_001, 1_700_002, 1_700_003)  # held-out terrain
STAIRS = (1.85, 3.85)  # where the slope begins and ends [m]
WALKING, SPEED, TIME_STEP = 0.93, 0.1, 0.2  # [m], [m/s], [s]


def guides_up_stairs(seed: int, count: int) -> tuple[Scene, list[GuidePath]]:
    """Return stairs and straight guides from uniform starts to the middle of the top."""
    scenario = transition("stairs_up", seed)
    rng = np.random.default_rng(seed)
    low, high = zip(*[(a[::2], a[1::2]) for a in scenario.start_areas], strict=True)
    starts = rng.uniform(np.min(low, axis=0), np.max(high, axis=0), (count, 2))
    goal = np.reshape(scenario.goal_area, (2, 2)).mean(axis=1)
    top = float(list(scenario.scene.surfaces.values())[-1][0, 2])
    return scenario.scene, [_straight(start, goal, top) for start in starts]


def _straight(start: np.ndarray, goal: np.ndarray, top: float) -> GuidePath:
    rows = 1 + round(float(np.linalg.norm(goal - start)) / (SPEED * TIME_STEP))
    flat = np.linspace(start, goal, rows)
    height = np.interp(flat[:, 0], STAIRS, (0.0, top)) + WALKING
    position = np.column_stack([flat, height])
    yaw = np.full(rows, np.arctan2(*(goal - start)[::-1]))
    velocity = np.gradient(position, TIME_STEP, axis=0)
    time = TIME_STEP * np.arange(rows)
    return GuidePath(time, position, yaw, velocity, np.ones(rows, bool))


def against_samples_and_step(count: int) -> Iterator[Row]:
    """Measure both curves; a run is one seed of terrain, starts and database.

    Args:
        count: number of guides per seed.
    """
    for samples in SAMPLES:
        yield from _rows(f"contacts_sampling_{samples}_samples", samples, FINE, count)
    for kept in KEPT:
        yield from _rows(f"contacts_sampling_{2 * kept}_cm", 25_000, kept, count)


def _rows(name: str, samples: int, kept: int, count: int) -> Iterator[Row]:
    success: list[float] = []
    times: list[float] = []
    for number, seed in enumerate(TERRAIN_SEEDS):
        settings = SamplingSettings(samples=samples, seed=number, keep_every=kept)
        scene, guides = guides_up_stairs(seed, count)
        plan_contacts(scene, guides[0], settings, robot=TALOS)  # makes the database
        plans = [plan_contacts(scene, guide, settings, robot=TALOS) for guide in guides]
        success.append(100.0 * float(np.mean([plan.reached for plan in plans])))
        whole = [1000.0 * plan.seconds for plan in plans if plan.success]
        times += [float(np.mean(whole))] if whole else []
    yield Row(f"{name}_success", "%", success, better="higher")
    # From the seeds with a completely reached guide.
    yield Row(f"{name}_time", "ms", times or [None])
