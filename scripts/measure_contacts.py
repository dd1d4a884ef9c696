"""Measure the exact planners and write benchmarks/results/contacts.json.

    python scripts/measure_contacts.py REFERENCE POLYTOPES [--out FILE] [--without-guide-limit S]

REFERENCE is contact-problems.jsonl.gz, POLYTOPES talos-polytopes.json. Each time is the least of
three runs (the machine is shared); medians are over problems. The long scenario is our own terrain
in the manner of T figure 5.4: rubble, a bridge and three stairs in a row, crossed along its middle.
"""

import argparse
import gzip
import json
import platform
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.contacts import ContactProblem, certify, plan_mip, plan_sl1m, problem_from_guide
from jaxleas.contacts.problem_file import parse_problem
from jaxleas.contacts.sl1m import attempt
from jaxleas.files import write_json
from jaxleas.terrain import Scene, transition
from jaxleas.types import GuidePath

OUT = Path(__file__).parents[1] / "benchmarks/results/contacts.json"
KINDS = ("rubble", "bridge", "stairs_up", "stairs_down", "stairs_up")
LENGTHS = (18, 36, 56, 74, 94)  # steps, as in T table 5.1
THESIS_WITH = (30, 75, 120, 218, 292)  # [ms], Gurobi
THESIS_WITHOUT = (330, 3400, 4700, 27200, 31000)
ABOVE_GROUND, STEP = 0.95, 0.25  # [m]


def long_scenario(seed: int) -> tuple[Scene, np.ndarray]:
    """Return 26 m of terrain, and the roots [95, 3] of a guide along its middle."""
    surfaces, shift, profile = {}, np.zeros(3), [(-2.0, 0.0)]
    for index, kind in enumerate(KINDS):
        scene = transition(kind, seed + index).scene
        parts = list(scene.surfaces.items())
        if index:  # its first tile is the last one of what came before
            parts = parts[1:]
        for name, vertices in parts:
            surfaces[f"{index}_{name}"] = vertices + shift
        rise = float(list(scene.surfaces.values())[-1][0, 2])
        x, z = shift[0], shift[2]
        profile += [(x + 2.0, z), (x + 4.0, z + rise)]
        shift = shift + np.array([4.0, 0.0, rise])
    along = 0.5 + STEP * np.arange(max(LENGTHS) + 1) * (20.5 / (STEP * max(LENGTHS)))
    height = np.interp(along, *np.array(profile).T)
    return Scene(surfaces), np.stack([along, 0.0 * along, height + ABOVE_GROUND], axis=1)


def long_problem(scene: Scene, roots: np.ndarray, steps: int) -> ContactProblem:
    """Return the problem of the first steps of the long scenario."""
    position = roots[: steps + 1]
    still = np.zeros(len(position))
    guide = GuidePath(still, position, still, np.zeros_like(position), still == 0.0)
    return problem_from_guide(guide, scene, every=1)


def timed(run: Callable[[], Any], repeats: int = 3) -> tuple[float, Any]:
    """Return the least time [ms] of some runs, and what the last returned."""
    times, answer = [], None
    for _ in range(repeats):
        begin = time.perf_counter()
        answer = run()
        times.append(1000.0 * (time.perf_counter() - begin))
    return min(times), answer


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description="Measure the exact contact planners.")
    parser.add_argument("reference", type=Path)
    parser.add_argument("polytopes", type=Path)
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--without-guide-limit", type=float, default=60.0)
    parser.add_argument("--only-long", action="store_true")
    arguments = parser.parse_args()
    rows: list[dict] = []

    def row(name: str, value: float, unit: str, better: str, **more) -> None:
        rival, ratio = more.get("rival"), more.get("ratio")
        limit = more.get("limit")
        rows.append(
            {
                "name": name,
                "value": round(float(value), 4),
                "unit": unit,
                "better": better,
                "runs": more.get("runs", 1),
                "machine": f"{platform.machine()}, two shared cores, one used",
                "rival": rival,
                "ratio": ratio,
                "limit": limit,
                "of_limit": None if not limit else round(float(value) / limit, 3),
            }
        )
        print(rows[-1], flush=True)

    if not arguments.only_long:
        measure_reference(arguments, row)
    measure_long(arguments, row)
    write_json(arguments.out, rows)


def measure_reference(arguments: argparse.Namespace, row: Callable) -> None:
    """Judge both planners on the reference set."""
    with gzip.open(arguments.reference, "rt") as stream:
        entries = [json.loads(line) for line in stream]
    sets = json.loads(arguments.polytopes.read_text())["sets"]
    for model in ("two_com", "feet"):
        right, times, sized, first, sl1m_times, violations = 0, [], [], [], [], [0.0]
        solved, false, count, published = 0, 0, 0, 0
        for entry in entries:
            verdict = entry["verdict"][model]
            if not verdict["robust"]:
                continue
            described = {**entry["problem"], "model": model}
            described["polytopes"] = sets[described["polytopes"]]
            asked = parse_problem(entry["id"], described)
            count, feasible = count + 1, verdict["status"] == "feasible"
            spent, plan = timed(lambda p=asked: plan_mip(p, diagnose=False))
            right += plan.feasible == feasible and plan.status in ("feasible", "infeasible")
            times.append(spent)
            if 17 <= len(asked) <= 19:
                sized.append(spent)
            relaxed, _ = timed(lambda p=asked: attempt(p, max_combinations=0))
            first.append(relaxed)
            run = lambda p=asked: plan_sl1m(p, diagnose=False, time_limit=20.0)  # noqa: E731
            spent, quick = timed(run, 1)
            sl1m_times.append(spent)
            solved, false = solved + quick.feasible, false + (quick.feasible and not feasible)
            violations += [certify(asked, each).metres for each in (plan, quick) if each.feasible]
            said = entry["published_sl1m_feet"]
            published += feasible and bool(said["success"] or said["l1_undecided"] == 0)
        name = f"contacts/{model}"
        row(f"{name}/mip_right", 100.0 * right / count, "%", "higher", runs=count, limit=100.0)
        row(f"{name}/mip_median", np.median(times), "ms", "lower", runs=count)
        row(f"{name}/mip_p90", np.percentile(times, 90), "ms", "lower", runs=count)
        row(f"{name}/mip_17_to_19_steps_median", np.median(sized), "ms", "lower",
            runs=len(sized), limit=60.0)  # fmt: skip
        row(f"{name}/sl1m_first_lp_median", np.median(first), "ms", "lower", runs=count, limit=10.0)
        row(f"{name}/sl1m_median", np.median(sl1m_times), "ms", "lower", runs=count)
        row(f"{name}/sl1m_solved", solved, "problems", "higher", runs=count,
            rival=f"published SL1M code, model feet: {published}")  # fmt: skip
        row(f"{name}/sl1m_false", false, "problems", "lower", runs=count)
        row(f"{name}/worst_violation", max(violations), "m", "lower", runs=count, limit=1e-6)


def measure_long(arguments: argparse.Namespace, row: Callable) -> None:
    """Plan with and without guide over path length (T table 5.1)."""
    scene, roots = long_scenario(seed=0)
    for steps, ours, theirs in zip(LENGTHS, THESIS_WITH, THESIS_WITHOUT, strict=True):
        asked = long_problem(scene, roots, steps)
        mean = np.mean([len(phase.candidates) for phase in asked.phases])
        print(f"{steps} steps, {len(scene.surfaces)} surfaces, {mean:.1f} candidates a step")
        spent, plan = timed(lambda p=asked: plan_mip(p, diagnose=False, time_limit=60.0))
        print(plan.status, plan.reason)
        limit = {18: 60.0, 94: 1000.0}.get(steps)
        row(f"contacts/long/{steps}_steps_with_guide_{plan.status}", spent, "ms", "lower", runs=3,
            rival=f"thesis, Gurobi: {ours} ms", ratio=round(spent / ours, 2),
            limit=limit)  # fmt: skip
        free, most = asked.without_guide(), arguments.without_guide_limit
        run = lambda p=free, s=most: plan_mip(p, diagnose=False, time_limit=s)  # noqa: E731
        spent, plan = timed(run, 1)
        row(f"contacts/long/{steps}_steps_without_guide_{plan.status}", spent, "ms", "lower",
            rival=f"thesis, Gurobi: {theirs} ms", ratio=round(spent / theirs, 2))  # fmt: skip


if __name__ == "__main__":
    main()
