"""`jaxleas transition check`, and what it refuses."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.dynamics import solve_transitions
from jaxleas.dynamics.croc.transition_file import read_transition
from jaxleas.types import InputError
from tests.dynamics.transitions import FEET

STANDING = [{"position": [*foot[:2].tolist(), 0.0]} for foot in FEET]
GOOD = {
    "mass": 30.5,
    "friction": 0.5,
    "force_limit": 350.0,
    "start": {"com": [0.0, 0.0, 0.45]},
    "end": {"com": [-0.05, 0.0, 0.45]},
    "phases": [
        {"duration": 0.8, "contacts": STANDING},
        {
            "duration": 0.8,
            "contacts": STANDING[1:],
            "reach": {"rows": [[0, 0, 2.0], [0, 0, -1.0]], "bounds": [1.2, 0.1]},
        },
    ],
}


@pytest.fixture
def write(tmp_path):
    def write(**changes):
        file = tmp_path / "transition.json"
        file.write_text(json.dumps({**GOOD, **changes}), encoding="utf-8")
        return file

    return write


def test_a_verdict_with_its_certificate(write, capsys):
    cli.run(["transition", "check", str(write()), "--solver", "jax", "--definition"])
    said = capsys.readouterr().out
    assert "transition.json: feasible, margin 0." in said
    assert "by HiGHS: margin 0." in said
    assert "certificate: margin " in said
    outside = {"com": [0.1, 0.1, 0.45]}  # of the triangle of the three feet
    cli.run(["transition", "check", str(write(end=outside)), "--solver", "jax"])
    assert "transition.json: infeasible, margin -" in capsys.readouterr().out


def test_no_support_is_said(write, capsys):
    phases = [GOOD["phases"][0], {**GOOD["phases"][1], "contacts": STANDING[:2]}]
    cli.run(["transition", "check", str(write(phases=phases)), "--solver", "jax"])
    assert "stands on nothing, on one point or on a line" in capsys.readouterr().out


def test_rectangles_are_four_points_and_edges_two(write):
    flat = {"position": [0.0, 0.0, 0.0], "half_size": [0.1, 0.05]}
    edge = {"position": [0.0, 0.0, 0.0], "half_size": [0.0, 0.05]}
    phases = [{"duration": 1.0, "contacts": [flat]}, {"duration": 1.0, "contacts": [edge]}]
    supports = read_transition(write(phases=phases)).transition.supports
    assert supports.standing.sum(axis=1).tolist() == [4, 2]
    np.testing.assert_allclose(np.abs(supports.points[0]), np.tile([0.1, 0.05, 0.0], (4, 1)))


def test_rows_of_any_length_mean_the_same(write):
    rows, bounds = read_transition(write()).transition.reach
    np.testing.assert_allclose(rows[1, 0], [[0, 0, 1], [0, 0, -1]])
    np.testing.assert_allclose(bounds[1, 0], [0.6, 0.1])


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"mass": -1.0}, "mass: Input should be greater than 0"),
        ({"friktion": 0.5}, "friktion: Extra inputs are not permitted"),
        ({"phases": []}, "phases: List should have at least 1 item"),
        ({"degree": 5}, "degree: Input should be 4 or 6"),
        ({"start": {"com": [0.0, 0.0]}}, "start.com"),
        ({"phases": [{"duration": 0.0, "contacts": []}]}, "phases.0.duration"),
        (
            {
                "phases": [
                    {"duration": 1.0, "contacts": [{**STANDING[0], "orientation": [1, 1, 0, 0]}]}
                ]
            },
            "phases.0.contacts.0.orientation: the unit quaternion",
        ),
        (
            {"phases": [{**GOOD["phases"][1], "reach": {"rows": [[1, 0, 0]], "bounds": []}}]},
            "phases.0.reach: 1 rows and 0 bounds",
        ),
        (
            {"phases": [{**GOOD["phases"][1], "reach": {"rows": [[0, 0, 0]], "bounds": [1]}}]},
            "phases.0.reach.rows.0 has no direction",
        ),
    ],
)
def test_bad_files_are_one_sentence(write, changes, sentence):
    with pytest.raises(InputError, match=sentence):
        read_transition(write(**changes))


def test_files_that_are_none(tmp_path):
    with pytest.raises(InputError, match=r"missing\.json"):
        read_transition(tmp_path / "missing.json")
    (tmp_path / "list.json").write_text("[]", encoding="utf-8")
    with pytest.raises(InputError, match="needs an object"):
        read_transition(tmp_path / "list.json")


def test_bad_options(write):
    with pytest.raises(InputError, match=r"--least -1\.0: give 0 or more"):
        cli.run(["transition", "check", str(write()), "--least", "-1"])


def test_a_missing_compiler_is_said(write, monkeypatch):
    monkeypatch.setattr("jaxleas.dynamics.croc.host_solver.has_compiler", lambda: False)
    with pytest.raises(InputError, match="needs numba: pip install 'jaxleas\\[gaits\\]'"):
        solve_transitions(read_transition(write()).transition, None, "compiled")
