"""Contacts on a sensor's height map: planned, checked, labelled as on a scene of polygons."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts.plan import read_plan
from jaxleas.contacts.problem_file import read_problem
from jaxleas.files import write_npz
from jaxleas.guide.roadmaps.exact import surfaces_near
from jaxleas.labels import read_verdicts
from jaxleas.terrain import HeightMap, read_scene, write_height_map
from jaxleas.types import InputError
from tests.contacts.test_from_guide import straight

CELL = 0.02
CONTACTS = ["contacts", "guide.npz", "--scene", "map.npz", "--out", "plan.json"]


def ground() -> HeightMap:
    """A floor with a step of 10 cm at x = 1, 4.2 x 2 m, and noise of 1 cm."""
    x = -0.6 + CELL * np.arange(210)
    heights = np.tile(0.1 * (x > 1.0), (100, 1))
    noise = 0.01 * np.random.default_rng(0).normal(size=heights.shape)
    return HeightMap((heights + noise).astype(np.float32), CELL, (-0.6, -0.99))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    guide = straight(3.0, 0.016)
    names = ("time", "position", "yaw", "velocity", "valid")
    write_npz("guide.npz", **{name: getattr(guide, name) for name in names})
    write_height_map("map.npz", ground())
    return tmp_path


def test_contacts_are_planned_on_the_surfaces_of_a_map(folder, capsys, caplog):
    cli.run([*CONTACTS, "--problem", "problem.json"])
    assert "mip: feasible" in capsys.readouterr().out
    assert "2 surfaces" in caplog.text
    cli.run(["check", "plan.json", "problem.json"])
    plan, asked = read_plan("plan.json"), read_problem("problem.json")
    assert len(asked) == len(plan.surfaces)
    feet = plan.footholds
    assert feet is not None
    assert np.abs(feet[:, 2] - 0.1 * (feet[:, 0] > 1.0)).max() < 0.003
    assert np.abs(feet[:, 0] - 1.0).min() > 0.5 * CELL


def test_options_of_reading_and_searching_reach_the_commands(folder):
    with pytest.raises(InputError, match="the guide starts where"):  # the ground is 2 m higher
        cli.run([*CONTACTS, "--origin", "0,0,-2"])
    with pytest.raises(InputError, match="no surface was found"):
        cli.run([*CONTACTS, "--min-area", "100"])
    check = [
        "check",
        "plan.json",
        "--guide",
        "guide.npz",
        "--scene",
        "map.npz",
        "--crop",
        "9",
        "10",
        "9",
        "10",
    ]
    cli.run([*CONTACTS, "--planner", "sampling", "--every", "50"])
    with pytest.raises(InputError, match="--crop leaves"):
        cli.run([*check, *["--crop", "9", "10", "9", "10"]])


def test_options_of_a_scene_need_a_scene(folder):
    cli.run([*CONTACTS, "--problem", "problem.json"])
    with pytest.raises(InputError, match="without --scene"):
        cli.run(["check", "plan.json", "problem.json", "--inset", "0.1"])


def test_labels_keep_the_scene_that_was_found(folder, capsys):
    label = "label guide.npz --scene map.npz --planner mip --out labels --processes 1"
    cli.run(label.split())
    assert "1 of 1 guide paths succeed" in capsys.readouterr().out
    assert len(read_scene("labels/scene.json").surfaces) == 2
    ((provenance, verdict),) = read_verdicts("labels")
    assert provenance["scene"]["file"] == "scene.json"
    assert verdict.success
    cli.run(label.split())
    assert "0 judged now" in capsys.readouterr().out
    with pytest.raises(InputError, match=r"is another scene than what .* gives now"):
        cli.run([*label.split(), "--inset", "0.1"])
    assert len(read_scene("labels/scene.json").surfaces) == 2


def test_a_path_is_checked_on_the_surfaces_around_it(caplog):
    found = surfaces_near(ground(), straight(1.0, 0.016))
    assert found is not None
    assert "around the path: 2 surfaces" in caplog.text
    rough = ground()
    rough.heights[:] = 0.2 * np.random.default_rng(1).normal(size=rough.shape)
    assert surfaces_near(rough, straight(1.0, 0.016)) is None
