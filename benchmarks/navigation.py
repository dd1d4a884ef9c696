"""Random start-goal pairs on one terrain: LEAS and RB-Kino with the same roadmap search.

    python benchmarks/navigation.py runs/leas_p1 --terrain arena.stl --json out.json

After an interruption it continues where it stopped: pairs are kept in OUT.partial.jsonl until all
are done.
"""

import argparse
import hashlib
import json
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jaxleas.cli_guard import run_guarded
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import CellResult, Evaluation, now, wilson_interval, write_evaluation
from jaxleas.files import atomic_path
from jaxleas.guide import (
    KINO,
    LEAS,
    PATH,
    Budget,
    Edges,
    Method,
    Navigation,
    Navigator,
    Places,
    load_policy,
    make_navigator,
    policy_file,
    scene_of,
    start_motion,
)
from jaxleas.terrain import EVALUATION_SEED, import_terrain

METHODS: dict[str, Method] = {LEAS.key: LEAS, KINO.key: KINO}
TITLES = {LEAS.key: "LEAS", KINO.key: KINO.title}
COLOURS = {LEAS.key: PATH, KINO.key: "tab:orange"}
CLEARANCE = 0.3
"""Extent of the ground around each end of a pair [m], so that none is on top of a box."""
HOURS = 3600.0
BUDGETS = (50, 100, 200)
"""Smaller budgets whose results follow from the same searches [connections]."""


@dataclass(frozen=True)
class Row:
    """The result of one method on one pair.

    Attributes:
        pair: number of the pair.
        method: name of the method.
        reached: whether the goal was reached with each configuration valid, also by the exact
            conditions.
        waypoints: number of waypoints between start and goal.
        connections: number of connections that the search asked for.
        seconds: duration of the search [s].
        length: length of the path [m].
        walking: time along the path [s].
    """

    pair: int
    method: str
    reached: bool
    waypoints: int
    connections: int
    seconds: float
    length: float
    walking: float


def draw_pairs(places: Places, seed: int, count: int) -> np.ndarray:
    """Return starts and goals [count, 2, 2], uniform over where a robot can stand and move."""
    rng = np.random.default_rng(seed)
    return places.draw(rng, 2 * count, CLEARANCE).reshape(count, 2, 2)


def navigate_pair(
    navigator: Navigator, pair: np.ndarray, index: int, connections: int
) -> Navigation:
    """Return the answer to one pair, with the same budget and samples for every method."""
    start, goal = (tuple(map(float, each)) for each in pair)
    motion = start_motion(navigator.connector.places, start, goal, None)  # type: ignore[arg-type]
    return navigator.navigate(motion, np.array(goal), Budget(HOURS, connections), seed=index)


def within(rows: Sequence[Row], method: str, connections: int) -> list[Row]:
    """Return the rows of a method that a smaller budget would have given."""
    return [
        row if row.connections <= connections else replace(row, reached=False)
        for row in rows
        if row.method == method
    ]


def cell(name: str, method: str, rows: Sequence[Row]) -> CellResult:
    """Return the result of one method."""
    reached = [row for row in rows if row.reached]
    low, high = wilson_interval(len(reached), len(rows))
    share = round(len(reached) / len(rows), 6)

    def mean(values: list[float]) -> float | None:
        return round(float(np.mean(values)), 6) if values else None

    return CellResult(
        name=name,
        yaw=0.0,
        method=method,
        starts=len(rows),
        reached=share,
        invalid=0.0,
        stopped=round(1.0 - share, 6),
        low=round(low, 6),
        high=round(high, 6),
        mean_time=mean([row.walking for row in reached]),
        mean_length=mean([row.length for row in reached]),
        waypoints=mean([float(row.waypoints) for row in reached]),
    )


def summary(rows: Sequence[Row], count: int) -> str:
    """Return the table and the comparison on the pairs that both methods solved."""
    lines = [
        f"{'method':10}{'reached':>10}{'direct':>8}{'waypoints':>11}{'connections':>13}{'s':>7}"
    ]
    solved: dict[str, dict[int, Row]] = {}
    methods = list(dict.fromkeys(row.method for row in rows))
    for method in methods:
        own = [row for row in rows if row.method == method]
        solved[method] = {row.pair: row for row in own if row.reached}
        good = list(solved[method].values())
        lines.append(
            f"{TITLES[method]:10}{len(good):>6}/{len(own)}{sum(not r.waypoints for r in good):>8}"
            f"{_mean(r.waypoints for r in good):>11.2f}{_mean(r.connections for r in own):>13.0f}"
            f"{_mean(r.seconds for r in own):>7.2f}"
        )
    both = set.intersection(*(set(each) for each in solved.values())) if solved else set()
    either = set.union(*(set(each) for each in solved.values())) if solved else set()
    for method in methods:
        lines.append(
            f"{TITLES[method]} on the {len(both)} pairs that all solve:"
            f" {_mean(solved[method][pair].waypoints for pair in both):.2f} waypoints"
        )
    lines.append(f"{count - len(either)} of {count} pairs were solved by none")
    return "\n".join(lines)


def _mean(values) -> float:
    listed = list(values)
    return float(np.mean(listed)) if listed else math.nan


def draw(path: Path, places: Places, rows: Sequence[Row], pairs: np.ndarray, limit: int) -> None:
    """Draw success against connections, the methods' numbers of waypoints, and all pairs."""
    from matplotlib.figure import Figure

    from jaxleas.terrain import draw_height_map

    figure = Figure(figsize=(14, 6.4), layout="constrained")
    curve, arena = figure.subplots(1, 2, width_ratios=(1.0, 1.05))
    axis = np.arange(1, limit + 1)
    best: dict[str, set[int]] = {}
    for method in dict.fromkeys(row.method for row in rows):
        own = [row for row in rows if row.method == method]
        needed = np.sort([row.connections for row in own if row.reached])
        best[method] = {row.pair for row in own if row.reached}
        waypoints = _mean(row.waypoints for row in own if row.reached)
        curve.step(
            axis,
            100.0 * np.searchsorted(needed, axis, side="right") / len(own),
            where="post",
            color=COLOURS[method],
            label=f"{TITLES[method]}: {waypoints:.1f} waypoints on average",
            linewidth=2,
        )
    curve.set(
        xscale="log",
        xlim=(1, limit),
        ylim=(0, 100),
        xlabel="connections tried",
        ylabel=f"of {len(pairs)} pairs solved [%]",
    )
    curve.grid(color="0.9")
    curve.legend(loc="upper left")
    draw_height_map(places.terrain, ax=arena, colour_bar=False)
    leas, kino = best.get("leas_p1", set()), best.get("rb_kino", set())
    kinds = (
        ("both", leas & kino, "0.45", 0.6),
        ("LEAS alone", leas - kino, COLOURS["leas_p1"], 1.6),
        ("RB-Kino alone", kino - leas, COLOURS["rb_kino"], 1.6),
        ("none", set(range(len(pairs))) - leas - kino, "#c01030", 0.9),
    )
    for label, members, colour, width in kinds:
        for order, index in enumerate(sorted(members)):
            arena.plot(
                *pairs[index].T,
                "o-",
                color=colour,
                linewidth=width,
                markersize=2.5,
                alpha=0.75,
                label=f"{label}: {len(members)}" if order == 0 else None,
            )
    arena.legend(loc="upper left", fontsize="small", title="pairs solved by")
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=100)


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Return the parsed options."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("policy", type=Path, help="a run folder, a policy.npz or an .onnx")
    parser.add_argument("--terrain", type=Path, required=True)
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--connections", type=int, default=500, help="limit of each search [500]")
    parser.add_argument("--planner", choices=("rrt", "prm"), default="rrt")
    parser.add_argument("--methods", nargs="+", choices=tuple(METHODS), default=tuple(METHODS))
    parser.add_argument("--reach", type=float, help="length of a tree's edges for all methods [m]")
    parser.add_argument("--seed", type=int, default=EVALUATION_SEED)
    parser.add_argument("--json", type=Path, required=True)
    parser.add_argument("--picture", type=Path)
    return parser.parse_args(arguments)


def main() -> None:
    """Run the benchmark."""
    given = parse(sys.argv[1:])
    begin = time.perf_counter()
    policy = load_policy(given.policy)
    env = SteeringEnv(policy.config)
    places = Places(env, import_terrain(given.terrain))
    scene = scene_of(given.terrain)
    pairs = draw_pairs(places, given.seed, given.pairs)
    navigators = {
        name: make_navigator(
            places, each.make(env, policy), _edges(each, given.reach), given.planner, scene
        )
        for name, each in METHODS.items()
        if name in given.methods
    }
    partial = given.json.with_suffix(".partial.jsonl")
    rows = _kept(partial)
    done = {(row.pair, row.method) for row in rows}
    with partial.open("a", encoding="utf-8") as kept:
        for index, pair in enumerate(pairs):
            for name, navigator in navigators.items():
                if (index, name) in done:
                    continue
                found = navigate_pair(navigator, pair, index, given.connections)
                rows.append(_row(index, name, found))
                kept.write(json.dumps(vars(rows[-1])) + "\n")
                kept.flush()
            spent = time.perf_counter() - begin
            left = spent / (index + 1) * (len(pairs) - index - 1)
            print(
                f"\r{index + 1}/{len(pairs)} pairs, {left / 60:.0f} min left ", end="", flush=True
            )
    file = policy_file(given.policy) if given.policy.is_dir() else given.policy
    evaluation = Evaluation(
        suite="navigation",
        policy=str(given.policy),
        fingerprint=hashlib.sha256(file.read_bytes()).hexdigest(),
        robot=env.config.robot,
        seed=given.seed,
        created=now(),
        seconds=round(time.perf_counter() - begin, 2),
        cells=tuple(
            cell(
                f"{given.terrain.stem}_{budget}",
                f"{name}_{given.planner}",
                within(rows, name, budget),
            )
            for budget in (
                *(each for each in BUDGETS if each < given.connections),
                given.connections,
            )
            for name in navigators
        ),
    )
    write_evaluation(given.json, evaluation)
    if given.picture is not None:
        draw(given.picture, places, rows, pairs, given.connections)
    partial.unlink()
    print("\n" + summary(rows, len(pairs)))


def _edges(method: Method, reach: float | None) -> Edges:
    return method.edges if reach is None else replace(method.edges, reach=reach)


def _row(index: int, method: str, found: Navigation) -> Row:
    return Row(
        pair=index,
        method=method,
        reached=found.reached,
        waypoints=len(found.waypoints) - 1,
        connections=found.connections,
        seconds=round(found.seconds, 3),
        length=round(found.path.length, 4),
        walking=round(float(found.path.time[-1]), 3),
    )


def _kept(partial: Path) -> list[Row]:
    if not partial.is_file():
        return []
    lines = partial.read_text(encoding="utf-8").splitlines()
    return [Row(**json.loads(line)) for line in lines if line.endswith("}")]


if __name__ == "__main__":
    sys.exit(run_guarded(main))
