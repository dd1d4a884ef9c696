"""Measure the risk dial: exact success against share attempted and speed, for every threshold.

python scripts/measure_risk_dial.py --policy runs/leas_p1 --surrogate surrogate.npz \
    --labels labels --out benchmarks/results/risk_dial.json --picture docs/images/risk_dial.png

Three kinds of guide paths: LEAS's own on the held-out suites transitions, hole and wall; RB-Kino's
on the held-out suite thesis; and disturbed walks that the surrogate was fitted to, on the terrains
that it neither learned from nor was calibrated on.
"""

import argparse
import hashlib
import os
from pathlib import Path

import numpy as np

from jaxleas.contacts import stored_settings
from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation import (
    Guides,
    as_json,
    ask,
    cell_title,
    contender,
    draw_starts,
    foresee,
    join,
    make_grounds,
    make_suite,
    now,
    sweep,
)
from jaxleas.files import write_bytes, write_json
from jaxleas.guide import SteeringMethod, leas, load_policy, rb_kino
from jaxleas.labels import Judge
from jaxleas.reports import draw_dial
from jaxleas.surrogates import (
    FitSettings,
    Surrogate,
    foreseen_failure,
    read_labels,
    read_surrogate,
    require_fit,
    split_by_terrain,
)
from jaxleas.terrain import DEFAULT_RESOLUTION

THRESHOLDS = tuple(
    sorted({*np.round(np.arange(0.0, 0.9, 0.1), 2), *np.round(np.arange(0.8, 0.995, 0.01), 2)})
)
VERSION = 1
LEAS_SUITES, KINO_SUITES = ("transitions", "hole", "wall"), ("thesis",)


def main() -> None:
    """Walk, foresee, judge; write numbers and picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--policy", required=True)
    parser.add_argument("--surrogate", required=True)
    parser.add_argument("--labels", required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--picture", type=Path, required=True)
    parser.add_argument("--starts", type=int, default=60)
    parser.add_argument("--kino-starts", type=int, default=30)
    given = parser.parse_args()
    surrogate = read_surrogate(given.surrogate)
    policy = load_policy(given.policy)
    require_fit(surrogate, policy.config, where=given.surrogate)
    env = SteeringEnv(policy.config)
    identity = surrogate.identity
    settings = stored_settings(identity.planner, identity.parameters)
    kino = rb_kino(env.config.limits, env.config.desired_speed)
    curves = {}
    walks = disturbed(env, Path(given.labels), surrogate)
    curves[f"disturbed walks ({len(walks.reached)})"] = as_json(sweep(walks, THRESHOLDS))
    cores, robot = os.cpu_count() or 1, policy.config.robot
    with Judge(identity.planner, settings, processes=cores, robot=robot) as judge:
        for title, method, suites, starts in (
            ("LEAS-P1", leas(env, policy), LEAS_SUITES, given.starts),
            ("RB-Kino", kino, KINO_SUITES, given.kino_starts),
        ):
            cells = {
                name: guides
                for suite in suites
                for name, guides in cells_of(env, method, suite, starts, surrogate, judge).items()
            }
            whole = join(list(cells.values()))
            curves[f"{title} ({len(whole.reached)} starts)"] = as_json(sweep(whole, THRESHOLDS))
    content = {
        "version": VERSION,
        "created": now(),
        "policy": given.policy,
        "surrogate": hashlib.sha256(Path(given.surrogate).read_bytes()).hexdigest(),
        "labels": surrogate.report["guides"],
        "planner": identity.planner,
        "suites": {"leas_p1": LEAS_SUITES, "rb_kino": KINO_SUITES},
        "held_out": True,
        "seed": 0,
        "curves": curves,
    }
    write_json(given.out, content)
    title = f"Guide paths refused below a threshold, {identity.planner} planner"
    write_bytes(given.picture, draw_dial(curves, title))
    for name, settings_ in curves.items():
        print(name)
        for each in settings_:
            if each["threshold"] in (0.0, 0.5, 0.8, 0.9, 0.95):
                print("  ", each)


def disturbed(env: SteeringEnv, labels: Path, surrogate: Surrogate) -> Guides:
    """Return labelled walks on the terrains that only judged the surrogate's fit."""
    found = read_labels([labels], [], DEFAULT_RESOLUTION)
    settings = FitSettings()
    judged = split_by_terrain(found.paths, settings.held_out, settings.seed).judged
    survival = 1.0 - foreseen_failure(surrogate, env, found.atlas, judged)
    there = np.arange(judged.yaw.shape[1])[None, 1:] < judged.kept[:, None]
    way = np.linalg.norm(np.diff(judged.position, axis=1), axis=-1)
    keep = surrogate.identity.keep_every * env.config.limits.time_step
    speed = (way * there).sum(axis=1) / np.maximum(keep * there.sum(axis=1), keep)
    everyone = np.ones(len(judged), dtype=bool)
    return Guides(everyone, judged.failed_at < 0, survival, speed)


def cells_of(
    env: SteeringEnv,
    method: SteeringMethod,
    name: str,
    count: int,
    surrogate: Surrogate,
    judge: Judge,
) -> dict[str, Guides]:
    """Return each cell of a held-out suite as walked, foreseen and judged."""
    suite = make_suite(name, count, held_out=True)
    grounds = make_grounds(suite.cells)
    time_step = env.config.limits.time_step
    found = {}
    for cell in suite.cells:
        starts = draw_starts(env, grounds, cell, suite.stream())
        walked = contender(env, method)(grounds, starts, suite.steps_of(cell))
        judged = ask(cell, walked, judge, time_step)
        title = f"{cell_title(cell.name)} {cell.yaw:.0f}° {cell.speed:.2f}"
        each = foresee(env, grounds.atlas, judged, surrogate, time_step)
        found[title] = each
        median = float(np.median(each.survival[each.reached])) if each.reached.any() else 0.0
        counts = int(each.reached.sum()), int(each.planned.sum())
        print(title, *counts, f"median foreseen {median:.3f}", flush=True)
    return found


if __name__ == "__main__":
    main()
