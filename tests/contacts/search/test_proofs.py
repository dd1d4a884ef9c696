"""Proofs that there is no plan: verified, and refused where they are wrong."""

import json
from dataclasses import replace

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import InfeasibilityProof, certify_infeasible, plan_astar, read_plan
from jaxleas.contacts.checking import NotCertifiedError
from jaxleas.files import write_json
from jaxleas.types import InputError
from tests.contacts.search.worlds import tilted_world
from tests.contacts.worlds import problem, reference_entries, reference_problem, stones

MODELS = ["two_com", "feet"]
STOPPED = {("two_com", False): (11, 13), ("two_com", True): (0, 10), ("feet", False): (11, 13)}
STOPPED["feet", True] = (1, 11)


def proved(asked) -> InfeasibilityProof:
    plan = plan_astar(asked, diagnose=False)
    assert plan.status == "infeasible"
    assert plan.proof is not None
    return plan.proof


@pytest.mark.parametrize("twice", [False, True])
@pytest.mark.parametrize("model", MODELS)
def test_proofs_hold(model: str, twice: bool) -> None:
    for seed in STOPPED[model, twice]:
        asked = problem(tilted_world(seed, model, twice=twice))
        report = certify_infeasible(asked, proved(asked))
        assert report.holds, (seed, report.complaint)


@pytest.mark.parametrize("model", MODELS)
def test_proofs_of_verdicts_from_outside_hold(shared, model: str) -> None:
    count = 0
    for entry in reference_entries(shared):
        verdict = entry["verdict"][model]
        if verdict["robust"] and verdict["status"] == "infeasible":
            asked = reference_problem(shared, entry, model)
            report = certify_infeasible(asked, proved(asked))
            assert report.holds, (entry["id"], report.complaint)
            count += 1
    assert count == {"two_com": 12, "feet": 20}[model]


def without(proof: InfeasibilityProof, number: int, **changes) -> InfeasibilityProof:
    sets = list(proof.sets)
    sets[number] = replace(sets[number], **changes)
    return InfeasibilityProof(tuple(sets))


@pytest.mark.parametrize("model", MODELS)
def test_a_lead_that_is_left_out_is_missed(model: str) -> None:
    """Each lead to a set that is not empty is needed."""
    asked = problem(tilted_world(11, model))
    proof, missed = proved(asked), 0
    for number, held in enumerate(proof.sets):
        for name in held.leads:
            leads = {key: index for key, index in held.leads.items() if key != name}
            report = certify_infeasible(asked, without(proof, number, leads=leads))
            missed += "can be made, with" in report.complaint
    assert missed >= 3


@pytest.mark.parametrize("model", MODELS)
def test_a_set_that_is_too_small_is_found_out(model: str) -> None:
    asked = problem(tilted_world(11, model))
    proof = proved(asked)
    for number, held in enumerate(proof.sets[1:], start=1):
        middle = held.vertices.mean(axis=0)
        smaller = middle + 0.99 * (held.vertices - middle)
        report = certify_infeasible(asked, without(proof, number, vertices=smaller))
        assert "m beyond set" in report.complaint


def test_what_is_no_proof_says_why() -> None:
    asked = problem(tilted_world(11, "feet"))
    proof = proved(asked)
    first, second = proof.sets[:2]
    name = next(iter(first.leads))
    crossed = [0, 2, 1, *range(3, len(second.vertices))]
    wrong = {
        "not the place where": without(proof, 0, vertices=first.vertices + 0.1),
        "which is of another step": without(proof, 0, leads={**first.leads, name: 0}),
        "no candidate of step 0": without(proof, 0, leads={**first.leads, "nowhere": 1}),
        "is not in the plane": without(proof, 1, vertices=second.vertices + np.array([0, 0, 1e-4])),
        "no surface of the problem": without(proof, 1, surface="nowhere"),
        "is no convex polygon": without(proof, 1, vertices=second.vertices[crossed]),
        "after the last step": without(proof, 1, step=len(asked)),
        "set 0 is not": InfeasibilityProof(proof.sets[1:]),
    }
    for words, each in wrong.items():
        assert words in certify_infeasible(asked, each).complaint


@pytest.mark.parametrize("model", MODELS)
def test_a_proof_of_one_problem_is_none_of_a_freer_one(model: str) -> None:
    described = stones(0.45, model=model)
    proof = proved(problem(described))
    assert certify_infeasible(problem(described), proof).holds
    assert not certify_infeasible(problem(stones(0.1, model=model)), proof).holds
    wider = json.loads(json.dumps(described))
    for each in wider["polytopes"].values():
        each["b"] = [bound + 0.2 for bound in each["b"]]
    report = certify_infeasible(problem(wider), proof)
    assert not report.holds


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_json("wide.json", stones(0.45))
    return tmp_path


def test_plan_then_check(folder, capsys) -> None:
    for free in ([], ["--without-guide"]):
        cli.run(["plan", "wide.json", "--planner", "astar", "--out", "plan.json", *free])
        assert "astar: infeasible (3 of 4 steps can be made)" in capsys.readouterr().out
        cli.run(["check", "plan.json", "wide.json", *free])
        text = capsys.readouterr().out
        assert "plan.json is certified: there is no plan of 4 steps" in text
    plan = read_plan("plan.json")
    assert plan.proof is not None
    assert all(np.isfinite(each.vertices).all() for each in plan.proof.sets)


def test_a_proof_that_was_tampered_with(folder) -> None:
    cli.run(["plan", "wide.json", "--planner", "astar", "--out", "plan.json"])
    written = json.loads((folder / "plan.json").read_text())
    written["proof"][0]["leads"] = {}
    write_json("plan.json", written)
    with pytest.raises(NotCertifiedError, match=r"no proof for wide.json: step 0 from set 0 onto"):
        cli.run(["check", "plan.json", "wide.json"])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"step": -1}, "set 1: step must be a whole number"),
        ({"step": True}, "set 1: step must be a whole number"),
        ({"surface": 3}, "set 1: surface must be a name, or null"),
        ({"vertices": []}, "set 1: vertices must be a list of at least one"),
        ({"vertices": [[0, 0]]}, "set 1: vertices must be a list"),
        ({"vertices": [[0, 0, None]]}, "set 1: vertices must be a list"),
        ({"leads": {"start": 999}}, "set 1: leads must give each surface the index"),
        ({"leads": ["start"]}, "set 1: leads must give each surface the index"),
    ],
)
def test_a_damaged_proof_is_refused(folder, change: dict, words: str) -> None:
    cli.run(["plan", "wide.json", "--planner", "astar", "--out", "plan.json"])
    written = json.loads((folder / "plan.json").read_text())
    written["proof"][1] |= change
    write_json("plan.json", written)
    with pytest.raises(InputError, match=words):
        read_plan("plan.json")
