"""The three commands, from files to files, and their pictures."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts.checking import NotCertifiedError
from jaxleas.contacts.pictures import draw_plan, failing_candidates
from jaxleas.contacts.plan import read_plan
from jaxleas.contacts.problem_file import read_problem
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.files import write_json, write_npz
from jaxleas.types.errors import InputError
from tests.contacts.test_from_guide import straight
from tests.contacts.worlds import problem, rectangle, stones


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_json("good.json", stones(0.1))
    write_json("wide.json", stones(0.45))
    guide = straight(3.0, 0.016)
    names = ("time", "position", "yaw", "velocity", "valid")
    write_npz("guide.npz", **{name: getattr(guide, name) for name in names})
    write_json("scene.json", {"surfaces": {"floor": rectangle(-1, 5, -1, 1)}})
    return tmp_path


@pytest.mark.parametrize("planner", ["mip", "sl1m", "astar"])
def test_plan_then_check(folder, capsys, planner: str) -> None:
    cli.run(f"plan good.json --planner {planner} --out plan.json --picture plan.png".split())
    assert f"{planner}: feasible, 4 steps" in capsys.readouterr().out
    assert (folder / "plan.png").stat().st_size > 5000
    cli.run(["check", "plan.json", "good.json"])
    assert "plan.json is certified: 4 steps" in capsys.readouterr().out
    written = json.loads((folder / "plan.json").read_text())
    assert written["certificate"]["max_violation_m"] <= 1e-6
    assert len(written["surfaces"]) == len(written["footholds"]) == len(written["com"]) == 4
    assert written["last_feasible_phase"] == 3


def test_a_plan_that_was_tampered_with(folder) -> None:
    cli.run(["plan", "good.json", "--out", "plan.json"])
    written = json.loads((folder / "plan.json").read_text())
    written["footholds"][2][2] += 0.01
    write_json("plan.json", written)
    with pytest.raises(NotCertifiedError, match=r"surface's plane, step 2: 0.01 m") as caught:
        cli.run(["check", "plan.json", "good.json"])
    assert caught.value.exit_code == 1


def test_an_infeasible_problem_is_an_answer(folder, capsys) -> None:
    cli.run(["plan", "wide.json", "--out", "plan.json", "--picture", "why.png"])
    text = capsys.readouterr().out
    assert "mip: infeasible (3 of 4 steps can be made)" in text
    assert "first step that cannot be made" in text
    plan = read_plan(folder / "plan.json")
    assert plan.status == "infeasible"
    assert plan.reason in text
    assert (folder / "why.png").stat().st_size > 5000
    with pytest.raises(InputError, match="is 'infeasible' and has no footholds"):
        cli.run(["check", "plan.json", "wide.json"])


def test_contacts_from_guide_to_plan(folder, capsys) -> None:
    line = "contacts guide.npz --scene scene.json --out plan.json --problem made.json"
    cli.run([*line.split(), "--cost", "linear", "--picture", "plan.svg"])
    assert "mip: feasible, 14 steps" in capsys.readouterr().out
    made = read_problem(folder / "made.json")
    assert len(made) == 14
    cli.run(["check", "plan.json", "made.json"])
    assert (folder / "plan.svg").read_text().lstrip().startswith("<?xml")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plan missing.json --out plan.json", "missing.json does not exist"),
        ("plan scene.json --out plan.json", "scene.json is not a contact problem"),
        ("plan good.json --out plan.txt", "written as .json"),
        ("plan good.json --out plan.json --picture p.gif", "pictures are .png"),
        ("plan good.json --out plan.json --time-limit 0", "positive number of seconds"),
        ("plan good.json --out plan.json --planner sl1m --cost linear", "for the planner mip"),
        ("contacts guide.npz --scene good.json --out plan.json --every 0", "every 0"),
        ("contacts guide.npz --scene scene.json --out plan.json --query 3", "no path 3"),
        ("check good.json good.json", "is not a contact plan"),
    ],
)
def test_a_mistake_writes_no_plan(folder, line: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        cli.run(line.split())
    assert not (folder / "plan.json").exists()
    assert not (folder / "plan.txt").exists()


def test_late_is_written_as_late(folder) -> None:
    cli.run(["plan", "good.json", "--out", "plan.json", "--time-limit", "1e-6"])
    assert read_plan(folder / "plan.json").status == "time_limit"


def test_without_guide_every_surface_is_a_candidate(folder) -> None:
    cli.run(["plan", "good.json", "--without-guide", "--out", "plan.json"])
    free = problem(stones(0.1)).without_guide()
    assert all(len(phase.candidates) == 5 for phase in free.steps[:-1])
    assert read_plan(folder / "plan.json").feasible


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"status": "maybe"}, "status must be one of"),
        ({"footholds": [[0, 0]]}, "footholds must hold 4 x 3 numbers"),
        ({"surfaces": "start"}, "surfaces must be a list"),
        ({"com": [[[1, 2, 3]]]}, "com must hold 4 x 2 x 3 numbers"),
    ],
)
def test_a_damaged_plan_is_refused(folder, change: dict, words: str) -> None:
    cli.run(["plan", "good.json", "--out", "plan.json"])
    write_json("plan.json", {**json.loads((folder / "plan.json").read_text()), **change})
    with pytest.raises(InputError, match=words):
        read_plan("plan.json")


def test_the_picture_of_a_failure_marks_the_step(tmp_path) -> None:
    asked = problem(stones(0.45))
    plan = plan_mip(asked)
    assert plan.last_feasible_step is not None
    failing = asked.steps[plan.last_feasible_step + 1]
    assert failing_candidates(asked, plan) == failing.candidates
    draw_plan(tmp_path / "a.svg", asked, plan)
    assert "ff00ff" in (tmp_path / "a.svg").read_text()
    good = plan_mip(problem(stones(0.1)))
    assert failing_candidates(asked, good) == ()
    assert np.isfinite(good.footholds).all()
