"""The model of contact problems where none is stated: chosen for the robot, said, recorded."""

import json
from dataclasses import replace

import pytest

from jaxleas import cli
from jaxleas.contacts import problem_from_guide, read_plan, read_problem
from jaxleas.contacts.models import default_model, default_model_of, model_note
from jaxleas.contacts.problem_file import parse_problem
from jaxleas.contacts.programs.settings import MipSettings
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import Oracle, read_verdicts
from jaxleas.robots import load_talos, write_robot
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.effectors import FLOOR, tripod
from tests.contacts.sampling.worlds import straight
from tests.contacts.test_effectors import guide

THREE = "two_com is for two feet, not for 3"
PLAIN = "two_com needs step polytopes COM_in_LF and COM_in_RF, which are missing"


def plain():
    """Return Talos without step polytopes of its centre of mass."""
    talos = load_talos()
    steps = {name: each for name, each in talos.steps.items() if not name.startswith("COM")}
    return replace(talos, name="plain", steps=steps)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_robot("robots/tripod.json", tripod())
    write_robot("robots/plain.json", plain())
    write_guide_paths(tmp_path / "three.npz", [guide()], ["reached"])
    write_guide_paths(tmp_path / "two.npz", [straight(1.2)], ["reached"])
    write_scene(tmp_path / "floor.json", Scene({"floor": FLOOR}))
    return tmp_path


def test_two_com_is_chosen_where_it_can_be(here) -> None:
    assert default_model(("LF", "RF"), ("RF", "LF")) == "two_com"
    assert default_model(("LF", "RF"), ("RF",)) == "feet"
    assert default_model(("A", "B", "C"), ("A", "B", "C")) == "feet"
    names = ("talos", "g1", "plain", "tripod")
    assert [default_model_of(name) for name in names] == ["two_com", "two_com", "feet", "feet"]
    assert [bool(model_note(None, name)) for name in names] == [False, False, True, True]
    assert model_note("feet", "tripod") == ""


def test_settings_are_recorded_as_they_were_for_a_robot_with_both_models() -> None:
    _, settings = Oracle("mip", robot="talos").find()
    assert settings.model_dump(mode="json")["model"] == "two_com"
    assert (
        Oracle("mip", MipSettings(model="feet"), robot="talos").find()[1].model_dump()["model"]
        == "feet"
    )


@pytest.mark.parametrize(
    ("robot", "file", "why"), [("tripod", "three", THREE), ("plain", "two", PLAIN)]
)
def test_labels_need_no_model(here, capsys, robot, file, why) -> None:
    line = f"label {file}.npz --scene floor.json --robot {robot} --planner mip --keep-every 5"
    cli.run([*line.split(), "--processes", "1", "--out", "labels"])
    assert f"contacts of {robot} are planned with model feet: {why}\n" in capsys.readouterr().out
    ((provenance, verdict),) = read_verdicts("labels")
    assert verdict.success
    assert provenance["parameters"]["model"] == "feet"
    cli.run([*line.split(), "--model", "feet", "--processes", "1", "--out", "labels"])
    said = capsys.readouterr().out
    assert "0 judged now" in said
    assert "are planned with model" not in said


def test_contacts_need_no_model(here, capsys) -> None:
    for robot, file, why in (("tripod", "three", THREE), ("plain", "two", PLAIN)):
        line = f"contacts {file}.npz --scene floor.json --robot {robot} --every 5 --out plan.json"
        cli.run([*line.split(), "--problem", "problem.json"])
        assert read_plan("plan.json").feasible
        assert why in capsys.readouterr().out
        assert read_problem("problem.json").model == "feet"
        with pytest.raises(InputError, match="two_com"):
            cli.run([*line.split(), "--model", "two_com"])
    scene = Scene({"floor": FLOOR})
    assert problem_from_guide(straight(1.2), scene, "talos").model == "two_com"
    steps = load_talos().steps
    described = {
        "robot": "plain",
        "model": "two_com",
        "surfaces": {"floor": FLOOR.tolist()},
        "initial": {
            foot: {"position": [0.0, side, 0.0], "yaw": 0.0}
            for foot, side in (("LF", 0.1), ("RF", -0.1))
        },
        "phases": [{"foot": "LF", "yaw": 0.0, "candidates": ["floor"]}],
        "polytopes": {
            name: {"A": each.normals.tolist(), "b": each.offsets.tolist()}
            for name, each in steps.items()
        },
    }
    own = parse_problem("p.json", json.loads(json.dumps(described))).polytopes
    made = problem_from_guide(straight(1.2), scene, "plain", polytopes=own)
    assert made.model == "two_com", "polytopes that are given count, not the robot's"
