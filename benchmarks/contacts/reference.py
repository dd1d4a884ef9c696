"""Both planners on problems with independent verdicts."""

import gzip
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.contacts.rows import Row, milliseconds
from jaxleas.contacts import (
    ContactProblem,
    attempt,
    certify,
    certify_infeasible,
    parse_problem,
    plan_astar,
    plan_mip,
    plan_sl1m,
)

MODELS = ("two_com", "feet")


def on_reference(problems: Path, polytopes: Path) -> Iterator[Row]:
    """Judge both planners on the robust entries, one model after the other.

    A problem's time is the median of three runs; the figures are over problems. The rival of
    `sl1m_solved` is the published SL1M code, model feet.

    Args:
        problems: file of the contact problems, contact-problems.jsonl.gz.
        polytopes: file of the step polytopes, talos-polytopes.json.
    """
    entries, sets = _read(problems, polytopes)
    for model in MODELS:
        yield from _with_model(model, entries, sets)


def sets_on_reference(problems: Path, polytopes: Path) -> Iterator[Row]:
    """Judge the search over sets of places on the robust entries of both models, and its proofs.

    Args:
        problems: file of the contact problems, contact-problems.jsonl.gz.
        polytopes: file of the step polytopes, talos-polytopes.json.
    """
    entries, sets = _read(problems, polytopes)
    right, times, held = [], [], []
    for model in MODELS:
        for entry, asked, feasible in _robust(model, entries, sets):
            taken, plan = milliseconds(lambda p=asked: plan_astar(p, diagnose=False), 1)
            times += taken
            right.append(plan.status == ("feasible" if feasible else "infeasible"))
            if not right[-1]:
                print(f"{entry['id']} {model}: {plan.status}", flush=True)
            if plan.proof is not None:
                held.append(certify_infeasible(asked, plan.proof).holds)
    print(f"{sum(right)} of {len(right)} right, {sum(held)} of {len(held)} proofs hold", flush=True)
    yield Row("astar_reference_right", "%", [100.0 * float(np.mean(right))], None, 100.0, "higher")
    yield Row(
        "astar_reference_proofs_held", "%", [100.0 * float(np.mean(held))], None, 100.0, "higher"
    )
    yield Row("astar_reference_median", "ms", [float(np.median(times))])


def _read(problems: Path, polytopes: Path) -> tuple[list[dict], dict]:
    with gzip.open(problems, "rt") as stream:
        entries = [json.loads(line) for line in stream]
    return entries, json.loads(polytopes.read_text())["sets"]


def _robust(
    model: str, entries: list[dict], sets: dict
) -> Iterator[tuple[dict, ContactProblem, bool]]:
    """Yield each robust entry, its problem, and whether this has a plan."""
    for entry in entries:
        verdict = entry["verdict"][model]
        if verdict["robust"]:
            described = {**entry["problem"], "model": model}
            described["polytopes"] = sets[described["polytopes"]]
            asked = parse_problem(entry["id"], described)
            yield entry, asked, verdict["status"] == "feasible"


def _with_model(model: str, entries: list[dict], sets: dict) -> Iterator[Row]:
    right, mip, sized, first, sl1m, violations = [], [], [], [], [], [0.0]
    solved, false, published = 0, 0, 0
    for entry, asked, feasible in _robust(model, entries, sets):
        times, plan = milliseconds(lambda p=asked: plan_mip(p, diagnose=False), 3)
        right.append(plan.feasible == feasible and plan.status in ("feasible", "infeasible"))
        mip.append(float(np.median(times)))
        if 17 <= len(asked) <= 19:
            sized.append(mip[-1])
        times, _ = milliseconds(lambda p=asked: attempt(p, max_combinations=0), 3)
        first.append(float(np.median(times)))
        times, quick = milliseconds(
            lambda p=asked: plan_sl1m(p, diagnose=False, time_limit=20.0), 1
        )
        sl1m.append(times[0])
        solved, false = solved + quick.feasible, false + (quick.feasible and not feasible)
        violations += [certify(asked, each).metres for each in (plan, quick) if each.feasible]
        said = entry["published_sl1m_feet"]
        published += feasible and bool(said["success"] or said["l1_undecided"] == 0)
    name = f"contacts_{model}"
    yield Row(f"{name}_mip_right", "%", [100.0 * float(np.mean(right))], None, 100.0, "higher")
    yield Row(f"{name}_mip_median", "ms", [float(np.median(mip))])
    yield Row(f"{name}_mip_p90", "ms", [float(np.percentile(mip, 90))])
    yield Row(f"{name}_mip_17_to_19_steps", "ms", sized, None, 60.0)
    yield Row(f"{name}_sl1m_first_lp", "ms", [float(np.median(first))], None, 10.0)
    yield Row(f"{name}_sl1m_median", "ms", [float(np.median(sl1m))])
    yield Row(f"{name}_sl1m_solved", "problems", [solved], published, None, "higher")
    yield Row(f"{name}_sl1m_false", "problems", [false])
    yield Row(f"{name}_worst_violation", "m", [float(max(violations))], None, 1e-6)
