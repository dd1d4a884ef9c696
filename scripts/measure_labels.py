"""Measure how fast guide paths are judged, and write benchmarks/results/labels.json.

    python -m scripts.measure_labels --policy runs/leas_p1 --out benchmarks/results/labels.json

Guide paths are the policy's, on held-out terrain (never the evaluation's): 40 each on flat ground
and on each transition, and 40 over one arena of 5 x 30 tiles. Needs a quiet machine.
"""

import argparse
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import get_args

import jax.numpy as jnp
import numpy as np

from benchmarks.measurements import this_machine
from jaxleas.contacts import plan_contacts
from jaxleas.envs.steering import SteeringEnv
from jaxleas.files import write_json
from jaxleas.guide import Trips, leas, load_policy, paths, roll_out
from jaxleas.labels import Judge
from jaxleas.robots import load_robot
from jaxleas.terrain import (
    HELD_OUT_SEED,
    Area,
    GeneratorConfig,
    Scene,
    TransitionKind,
    generate_arena,
    make_atlas,
    rasterise,
    transition,
)
from jaxleas.types import GuidePath, RootMotion

TALOS = load_robot("talos")

SEED = HELD_OUT_SEED + 500_000  # far from the terrain that checkpoints are chosen on
SCENES, EACH = 4, 10
STEPS = 400


@dataclass(frozen=True)
class Walks:
    """Guide paths over scenes.

    Attributes:
        scenes: that are walked on.
        paths: of the policy.
        scene_index: of each path's scene.
    """

    scenes: list[Scene]
    paths: list[GuidePath]
    scene_index: list[int]


def make_walks(policy: Path) -> dict[str, Walks]:
    """Return guide paths by kind of terrain."""
    walker = load_policy(policy)
    env = SteeringEnv(walker.config)
    rng = np.random.default_rng(SEED)
    floor = np.array([[0.0, -1.0, 0.0], [6.0, -1.0, 0.0], [6.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
    areas = [((0.25, 1.75, -0.7, 0.7), (4.5, 5.5, -0.5, 0.5))]
    walks = {"flat": _walk(env, walker, [Scene({"floor": floor})], [areas], 40, rng)}
    for kind in get_args(TransitionKind):
        made = [transition(kind, SEED + number) for number in range(SCENES)]
        areas = [[(area, each.goal_area) for area in each.start_areas] for each in made]
        walks[kind] = _walk(env, walker, [each.scene for each in made], areas, EACH, rng)
    arena = generate_arena(GeneratorConfig(rows=5, columns=30), SEED)
    areas = [[(link.start_area, link.goal_area) for link in arena.links]]
    walks["arena"] = _walk(env, walker, [arena.scene], areas, 40, rng)
    return walks


def _walk(
    env: SteeringEnv,
    walker,
    scenes: list[Scene],
    areas: Sequence[Sequence[tuple[Area, Area]]],
    each: int,
    rng: np.random.Generator,
) -> Walks:
    """Walk from random places of start areas, any heading, to random places of goal areas."""
    maps = [rasterise(scene, 0.04) for scene in scenes]
    index = np.repeat(np.arange(len(scenes)), each)
    starts, goals = [], []
    for number, scene in enumerate(index.tolist()):
        start, goal = areas[scene][number % len(areas[scene])]
        starts.append(_stand(env, maps[scene], start, rng))
        goals.append(_stand(env, maps[scene], goal, rng))
    motion = RootMotion(
        position=jnp.asarray(starts, jnp.float32),
        velocity=jnp.zeros((len(index), 3), jnp.float32),
        yaw=jnp.asarray(rng.uniform(-np.pi, np.pi, len(index)), jnp.float32),
    )
    waypoints = jnp.asarray(goals, jnp.float32)[:, None]
    trips = Trips(make_atlas(maps), jnp.asarray(index), motion, waypoints)
    rollout = roll_out(env, leas(env, walker), trips, STEPS)
    return Walks(scenes, paths(rollout, env.config.limits.time_step), index.tolist())


def _stand(env: SteeringEnv, height_map, area: Area, rng: np.random.Generator) -> np.ndarray:
    while True:
        place = rng.uniform(area[0::2], area[1::2])
        height = float(height_map.height_at(place[None])[0])
        if np.isfinite(height):
            return np.array([*place, height + env.robot.walking_height])


def longest(walks: Walks, metres: float) -> tuple[Scene, GuidePath]:
    """Return the path whose length is nearest to some metres, and its scene."""
    best = int(np.argmin([abs(path.length - metres) for path in walks.paths]))
    return walks.scenes[walks.scene_index[best]], walks.paths[best]


def measure(walks: dict[str, Walks], processes: int, rounds: int, out: Path) -> None:
    """Measure, planner after planner, and write the figures so far after each."""
    found = []
    scene, path = longest(walks["stairs_up"], 4.0)
    plan_contacts(scene, path, robot=TALOS)  # makes the data base
    times = [
        _timed(lambda: plan_contacts(scene, path, robot=TALOS)) / path.length * 4.0
        for _ in range(rounds)
    ]
    found.append(_figure("labels/sampling/4_m_of_stairs", 1e3 * statistics.median(times), "ms",
                         "lower", rounds, 150.0))  # fmt: skip
    print(f"4 m of stairs: {found[0]['value']:.0f} ms")
    for planner in ("sampling", "mip", "sl1m"):
        with Judge(planner, processes=processes, robot="talos") as judge:
            warm = walks["flat"]
            judge.judge(warm.scenes, warm.paths, warm.scene_index)
            for kind, some in walks.items():
                times, good = [], 0
                for _ in range(rounds if planner == "sampling" else 1):
                    begun = perf_counter()
                    verdicts = judge.judge(some.scenes, some.paths, some.scene_index)
                    times.append(perf_counter() - begun)
                    good = sum(verdict.success for verdict in verdicts)
                rate = len(some.paths) / statistics.median(times)
                limit = 50.0 if planner == "sampling" and kind != "arena" else None
                found.append(_figure(f"labels/{planner}/{kind}", rate, "guides/s", "higher",
                                     len(times), limit))  # fmt: skip
                metres = statistics.mean(path.length for path in some.paths)
                print(
                    f"{planner:9}{kind:12}{rate:8.1f} guides/s, {metres:.1f} m each,"
                    f" {good} of {len(some.paths)} succeed",
                    flush=True,
                )
        write_json(out, found)


def _timed(call) -> float:
    begun = perf_counter()
    call()
    return perf_counter() - begun


def _figure(
    name: str, value: float, unit: str, better: str, runs: int, limit: float | None
) -> dict:
    share = None
    if limit is not None:
        share = value / limit if better == "higher" else limit / value
    return {
        "name": name,
        "value": float(f"{value:.5g}"),
        "unit": unit,
        "better": better,
        "runs": runs,
        "machine": this_machine(),
        "rival": None,
        "ratio": None,
        "limit": limit,
        "of_limit": None if share is None else float(f"{share:.4g}"),
    }


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--policy", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    measure(make_walks(given.policy), given.processes, given.rounds, given.out)


if __name__ == "__main__":
    main()
