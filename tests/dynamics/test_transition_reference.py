"""Verdicts of others: the reference's entries, and the published library where its wheel is."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from benchmarks.transitions.reference import read_verdicts
from jaxleas.dynamics import Discretisation, Ended, Limits, solve_transitions
from tests.dynamics.transitions import random_transitions

ALWAYS = Discretisation(degree=6, kind="everywhere")
TOO_CLOSE = 1e-3  # margins between which programs of different tolerances may disagree
SOMETIMES = Discretisation(degree=6, instants=25)  # 0.05 s apart in the longest phase


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "where", "entries"),
    [("continuous", ALWAYS, 394), ("disc_dt0p05", SOMETIMES, 396)],
)
def test_right_on_every_entry_on_which_others_agree(shared, kind, where, entries):
    """Their programs have no margin to spare: feasible is what reaches 0."""
    pytest.importorskip("numba")
    verdicts = read_verdicts(shared / "reference/croc.json.gz", kind)
    found = solve_transitions(verdicts.transitions, where, "compiled")
    assert len(verdicts.feasible) == entries
    assert (found.ended == Ended.CONVERGED).mean() > 0.99
    known = found.ended == Ended.CONVERGED
    wrong = [
        name
        for name, ours, theirs in zip(
            np.array(verdicts.names)[known],
            found.feasible(0.0)[known],
            verdicts.feasible[known],
            strict=True,
        )
        if ours != theirs
    ]
    assert wrong == []


ASK = """
import json, sys
import ndcurves  # first: the published library registers its types
import hpp_centroidal_dynamics as statics
import hpp_bezier_com_traj as published
import numpy as np
given = np.load(sys.argv[1])
found = []
for k in range(len(given["durations"])):
    problem, kept = published.ProblemData(), []
    for side, name in ((0, "c0_"), (1, "c1_")):
        setattr(problem, name, given["com"][side, k])
        setattr(problem, "d" + name, given["velocity"][side, k])
    for phase in range(2):
        standing = given["standing"][k, phase]
        points, normals = (given[name][k, phase][standing] for name in ("points", "normals"))
        support = statics.Equilibrium("transition", float(given["mass"]), 4)
        kind = statics.EquilibriumAlgorithm.EQUILIBRIUM_ALGORITHM_PP
        support.setNewContacts(points, normals, float(given["friction"]), kind)
        contact = published.ContactData(support)
        is_row = np.abs(given["rows"][k, phase]).max(axis=1) > 0
        bounds = given["bounds"][k, phase][is_row].reshape(-1, 1)
        contact.setKinematicConstraints(given["rows"][k, phase][is_row], bounds)
        kept += [support, contact]
        problem.addContact(contact)
    problem.constraints_.constrainAcceleration_ = True
    problem.constraints_.maxAcceleration_ = 10.0
    durations = given["durations"][k].reshape(-1, 1)
    found.append(bool(published.computeCOMTraj(problem, durations, -1.0).success))
print(json.dumps(found))
"""


@pytest.mark.skipif(
    importlib.util.find_spec("hpp_bezier_com_traj") is None,
    reason="the wheel hpp-bezier-com-traj (540 MB with what it needs) is not installed",
)
def test_agrees_with_the_published_library(tmp_path: Path) -> None:
    transitions = random_transitions(200, seed=5)._replace(limits=Limits(0.5, 10.0))
    points, normals, _, standing = transitions.supports
    ends = transitions.start, transitions.end
    np.savez(
        tmp_path / "transitions.npz",
        com=np.array([each.com for each in ends]),
        velocity=np.array([each.velocity for each in ends]),
        durations=transitions.durations,
        points=points,
        normals=normals,
        standing=standing,
        rows=transitions.reach.rows[:, :, 0],
        bounds=transitions.reach.bounds[:, :, 0],
        mass=30.475,
        friction=0.5,
    )
    spec = importlib.util.find_spec("hpp_bezier_com_traj")
    assert spec is not None
    assert spec.origin is not None
    prefix = next(each for each in Path(spec.origin).parents if each.name == "cmeel.prefix")
    answer = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", ASK, str(tmp_path / "transitions.npz")],
        env={**os.environ, "LD_LIBRARY_PATH": str(prefix / "lib")},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert answer.returncode == 0, answer.stderr
    theirs = np.array(json.loads(answer.stdout.splitlines()[-1]))
    found = solve_transitions(transitions, Discretisation(kind="everywhere"), "jax")
    is_clear = np.abs(found.margin) > TOO_CLOSE
    assert is_clear.mean() > 0.9
    assert theirs.any()
    assert not theirs.all()
    np.testing.assert_array_equal(found.feasible(0.0)[is_clear], theirs[is_clear])
