"""Measure how often the conditions on the height map and their exact twins disagree.

    python scripts/measure_conditions.py [--configurations N] [--seed S] [--out FILE.json]

On generated arenas, for random configurations of two kinds: *anywhere*, the root 0.55 to 1.20 m
above a point of a contact surface (or, over the void, above a random cell's ground); *walking*, the
root 0.88 to 1.00 m above a contact surface. Any heading; obstacles stand in both. Prints Markdown
tables, those in docs/conditions.md.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.conditions import (
    VOID_IN_ROOT,
    Condition,
    collision,
    exact_collision,
    exact_reachability,
    exact_strict_reachability,
    footprint_points,
    reachability,
    strict_reachability,
)
from jaxleas.files import write_json
from jaxleas.robots import load_talos
from jaxleas.terrain import GeneratorConfig, HeightMap, Scene, generate_arena, rasterise
from jaxleas.types import RootMotion

RESOLUTION = 0.04  # of the map [m], as in training
ARENAS = 20
HEIGHTS_ABOVE_GROUND = {"anywhere": (0.55, 1.20), "walking": (0.88, 1.00)}
NEAR = 0.02  # a margin within this of zero [m] is a close call


def draw_configurations(
    kind: str, ground: HeightMap, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return positions [count, 3] [m] and yaws [count] [rad] over one arena."""
    x_min, x_max, y_min, y_max = ground.extent
    grounds = ground.heights[np.isfinite(ground.heights)]
    xy, height = np.zeros((0, 2)), np.zeros(0)
    while len(height) < count:
        drawn = rng.uniform((x_min, y_min), (x_max, y_max), (count, 2))
        below = ground.height_at(drawn)
        if kind == "anywhere":
            below = np.where(np.isnan(below), rng.choice(grounds, count), below)
        kept = np.isfinite(below)
        xy, height = np.concatenate([xy, drawn[kept]]), np.concatenate([height, below[kept]])
    z = height[:count] + rng.uniform(*HEIGHTS_ABOVE_GROUND[kind], count)
    return np.column_stack([xy[:count], z]), rng.uniform(-np.pi, np.pi, count)


def sample_heights(
    terrain: HeightMap, points: np.ndarray, position: np.ndarray, yaw: np.ndarray
) -> np.ndarray:
    """Return the heights [N, P] [m] under the grid, in the root frame."""
    cosine, sine = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x = position[:, :1] + cosine * points[:, 0] - sine * points[:, 1]
    y = position[:, 1:2] + sine * points[:, 0] + cosine * points[:, 1]
    height = terrain.height_at(np.stack([x.ravel(), y.ravel()], axis=-1)).reshape(x.shape)
    return np.where(np.isnan(height), VOID_IN_ROOT, height - position[:, 2:])


def judge(
    condition: Condition, heights: np.ndarray, position: np.ndarray, yaw: np.ndarray
) -> np.ndarray:
    """Return the margins [N] [m] of the condition on the map."""
    motion = RootMotion(jnp.asarray(position), jnp.zeros_like(position), jnp.asarray(yaw))
    return np.asarray(jax.jit(condition)(jnp.asarray(heights, jnp.float32), motion))


def measure(kind: str, configurations: int, seed: int) -> list[dict]:
    """Return one row a condition: counts of the four cases, close calls, seconds of the twin."""
    robot = load_talos()
    points = footprint_points(robot)
    pairs: dict[str, tuple[Condition, Callable]] = {
        "R": (reachability(robot, points), exact_reachability),
        "R*": (strict_reachability(robot, points), exact_strict_reachability),
        "C": (collision(robot, points), exact_collision),
    }
    overhead: list[np.ndarray] = []
    margins: dict[str, list[np.ndarray]] = {name: [] for name in pairs}
    exact: dict[str, list[np.ndarray]] = {name: [] for name in pairs}
    seconds = 0.0
    for index in range(ARENAS):
        scene = generate_arena(GeneratorConfig(), seed=seed + index).scene
        terrain = rasterise(scene, RESOLUTION)
        ground = rasterise(Scene(scene.surfaces), RESOLUTION)
        rng = np.random.default_rng([seed, index])
        position, yaw = draw_configurations(kind, ground, configurations // ARENAS, rng)
        heights = sample_heights(terrain, points, position, yaw)
        overhead.append(_lies_overhead(heights))
        began = time.perf_counter()
        for name, (condition, twin) in pairs.items():
            # Nothing stands on an obstacle; anything may bump into one.
            polygons = scene.polygons if name == "C" else list(scene.surfaces.values())
            exact[name].append(twin(robot, polygons, position, yaw))
            margins[name].append(judge(condition, heights, position, yaw))
        seconds += time.perf_counter() - began
    margin = {name: np.concatenate(parts) for name, parts in margins.items()}
    verdict = {name: np.concatenate(parts) for name, parts in exact.items()}
    margin["R* and C"] = np.minimum(margin["R*"], margin["C"])
    verdict["R* and C"] = verdict["R*"] & verdict["C"]
    print(f"{kind}: {seconds:.1f} s for all verdicts")
    alone = (margin["C"] <= 0) & verdict["C"]
    share = float(np.concatenate(overhead)[alone].mean())
    print(f"C refused by the map alone because ground lies overhead: {100 * share:.0f} %")
    return [
        {"condition": name, "configurations": kind, **_count(margin[name], verdict[name])}
        for name in margin
    ]


def _lies_overhead(heights: np.ndarray) -> np.ndarray:
    # Whether all ground that the map's C objects to lies above the trunk's lowest box.
    lowest = min(load_talos().trunk, key=lambda box: box.low[2])
    objected = np.where(heights > lowest.low[2], heights, np.inf)
    return objected.min(axis=1) > lowest.high[2]


def _count(margin: np.ndarray, exact: np.ndarray) -> dict[str, int | float]:
    approved = margin > 0
    differ = approved != exact
    near = np.abs(margin[differ]) < NEAR
    return {
        "drawn": len(margin),
        "both_satisfied": int((approved & exact).sum()),
        "both_refused": int((~approved & ~exact).sum()),
        "map_alone_satisfied": int((approved & ~exact).sum()),
        "map_alone_refused": int((~approved & exact).sum()),
        "disagree_percent": round(100 * float(differ.mean()), 3),
        "of_these_near_percent": round(100 * float(near.mean()), 1) if differ.any() else 0.0,
    }


def print_table(rows: list[dict]) -> None:
    """Print the rows as a Markdown table."""
    print("| configurations | condition | both yes | both no | map alone yes | map alone no "
          "| disagree | of these within 2 cm |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|")
    for row in rows:
        print(
            f"| {row['configurations']} | {row['condition']} | {row['both_satisfied']} "
            f"| {row['both_refused']} | {row['map_alone_satisfied']} "
            f"| {row['map_alone_refused']} | {row['disagree_percent']:.2f} % "
            f"| {row['of_these_near_percent']:.0f} % |"
        )


def main() -> None:
    """Measure, print, and write the JSON file."""
    parser = argparse.ArgumentParser(description="Compare conditions with their exact twins.")
    parser.add_argument("--configurations", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    rows = [
        row
        for kind in HEIGHTS_ABOVE_GROUND
        for row in measure(kind, arguments.configurations, arguments.seed)
    ]
    print_table(rows)
    if arguments.out:
        write_json(arguments.out, {"seed": arguments.seed, "arenas": ARENAS, "rows": rows})


if __name__ == "__main__":
    main()
