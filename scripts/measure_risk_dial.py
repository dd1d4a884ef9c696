"""Measure the risk dial: exact success against speed and share attempted, for every threshold.

python -m scripts.measure_risk_dial --policy runs/leas_p1 --surrogate surrogate.npz \
    --out benchmarks/results/risk_dial.json --picture docs/images/risk_dial.png
"""

import argparse
import hashlib
import os
from pathlib import Path

import numpy as np

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.evaluation.exact import ask, walker
from jaxleas.evaluation.result_file import now
from jaxleas.evaluation.risk_dial import Guides, as_json, draw_dial, foresee, join, sweep
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.evaluation.suites import make_suite
from jaxleas.evaluation.table import cell_title
from jaxleas.files import write_bytes, write_json
from jaxleas.guide.leas import leas
from jaxleas.guide.loading import load_policy
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.labels import Judge
from jaxleas.labels.settings import settings_from
from jaxleas.surrogates import Surrogate, read_surrogate, require_fit

THRESHOLDS = (0.0, *np.round(np.arange(0.05, 0.951, 0.05), 2).tolist(), 0.96, 0.97, 0.98, 0.99)
VERSION = 1


def main() -> None:
    """Walk, foresee, judge; write numbers and picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--policy", required=True)
    parser.add_argument("--surrogate", required=True)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--picture", type=Path, required=True)
    parser.add_argument("--suites", nargs="+", default=["transitions", "hole", "wall"])
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    surrogate = read_surrogate(given.surrogate)
    policy = load_policy(given.policy)
    require_fit(surrogate, policy.config, where=given.surrogate)
    env = SteeringEnv(policy.config)
    identity = surrogate.identity
    settings = settings_from(identity.planner, **identity.parameters)
    cells: dict[str, Guides] = {}
    with Judge(identity.planner, settings, processes=os.cpu_count() or 1) as judge:
        for name in given.suites:
            cells |= _cells(env, leas(env, policy), name, given, surrogate, judge)
    curves = {"all cells": as_json(sweep(join(list(cells.values())), THRESHOLDS))}
    curves |= {name: as_json(sweep(each, THRESHOLDS)) for name, each in cells.items()}
    content = {
        "version": VERSION,
        "created": now(),
        "policy": given.policy,
        "surrogate": hashlib.sha256(Path(given.surrogate).read_bytes()).hexdigest(),
        "labels": surrogate.report["guides"],
        "planner": identity.planner,
        "suites": given.suites,
        "held_out": True,
        "seed": given.seed,
        "starts_a_cell": given.starts,
        "curves": curves,
    }
    write_json(given.out, content)
    hardest = sorted(cells, key=lambda name: cells[name].planned.sum() / cells[name].reached.sum())
    shown = {name: curves[name] for name in ("all cells", *hardest[:3])}
    title = f"Guide paths refused below a threshold: {identity.planner} planner, held-out scenes"
    write_bytes(given.picture, draw_dial(shown, title))
    for each in curves["all cells"]:
        print(each)


def _cells(
    env: SteeringEnv,
    method: SteeringMethod,
    name: str,
    given: argparse.Namespace,
    surrogate: Surrogate,
    judge: Judge,
) -> dict[str, Guides]:
    suite = make_suite(name, given.starts, given.seed, held_out=True)
    grounds = make_grounds(suite.cells)
    time_step = env.config.limits.time_step
    found = {}
    for cell in suite.cells:
        starts = draw_starts(env, grounds, cell, suite.stream())
        walked = walker(env, method)(grounds, starts, suite.steps_of(cell))
        judged = ask(cell, walked, judge, time_step)
        title = f"{cell_title(cell.name)} {cell.yaw:.0f}°"
        found[title] = foresee(env, grounds.atlas, judged, surrogate, time_step)
        print(title, int(found[title].reached.sum()), int(found[title].planned.sum()), flush=True)
    return found


if __name__ == "__main__":
    main()
