"""Whose guide path it is: the robot of its file, or what the height of its root tells."""

import json
from pathlib import Path

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import read_plan
from jaxleas.contacts.checking import followed_by
from jaxleas.contacts.guide_file import read_recorded_guide
from jaxleas.contacts.guide_robot import heights_above_ground
from jaxleas.guide import read_guide_paths, write_guide_paths
from jaxleas.labels import read_verdicts
from jaxleas.terrain import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, floor, stairs, straight

FLOOR = "floor.json"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_scene(FLOOR, flat())
    paths = [straight(0.6), straight(0.6, y=0.3)]
    write_guide_paths("talos.npz", paths, ["reached", "stopped"], robot="talos")
    low = [straight(0.6, height=0.62)]
    write_guide_paths("g1.npz", low, ["reached"], robot="g1")
    write_guide_paths("whose.npz", low, ["reached"])
    return tmp_path


def run(line: str) -> None:
    cli.run(line.split())


def refused(line: str) -> str:
    with pytest.raises(InputError) as stopped:
        run(line)
    return str(stopped.value)


def test_heights_are_those_of_a_slow_twin() -> None:
    scene = stairs()
    scene.surfaces["slope"] = np.array([[5, -1, 0], [6, -1, 0.5], [6, 1, 0.5], [5, 1, 0]], float)
    scene.surfaces["wall"] = np.array([[2, -1, 0], [2, 1, 0], [2, 1, 2], [2, -1, 2]], float)
    rng = np.random.default_rng(0)
    roots = rng.uniform([-2, -1.2, -0.2], [7, 1.2, 2.0], (300, 3))
    expected = []
    for x, y, z in roots:
        below = []
        for name, ((x0, y0, z0), _, (x1, y1, z1), _) in scene.surfaces.items():
            here = z0 + (x - x0) / (x1 - x0) * (z1 - z0) if x1 > x0 else np.inf
            if name != "wall" and x0 <= x <= x1 and y0 <= y <= y1 and here <= z:
                below.append(z - here)
        expected += [min(below)] if below else []
    assert 100 < len(expected) < 300
    np.testing.assert_allclose(heights_above_ground(scene, roots), expected, atol=1e-12)


def test_the_robot_is_recorded_and_planned_with(here, capsys) -> None:
    recorded = read_guide_paths("g1.npz").robot
    assert recorded is not None
    assert recorded.name == "g1"
    assert read_recorded_guide("g1.npz").robot == recorded
    run(f"contacts g1.npz --scene {FLOOR} --out plan.json --problem problem.json")
    assert "g1.npz was walked by g1, whose legs are taken" in capsys.readouterr().out
    assert json.loads((here / "problem.json").read_text())["robot"] == "g1"
    assert read_plan("plan.json").guide_ended == "reached"
    run(f"label g1.npz --scene {FLOOR} --planner mip --out labels --processes 1")
    ((provenance, _),) = read_verdicts("labels")
    assert provenance["robot"]["name"] == "g1"


def test_a_path_of_nobody_known_is_refused_where_talos_cannot_have_walked_it(here, capsys) -> None:
    for line in (
        f"label whose.npz --scene {FLOOR} --planner mip --out labels",
        f"contacts whose.npz --scene {FLOOR} --out plan.json",
    ):
        said = refused(line)
        assert "whose.npz does not say whose path it is, and its root is 0.62 m above" in said
        assert "(that of g1 could be): say by --robot whose path it is" in said
    assert not (here / "labels").exists()
    assert not (here / "plan.json").exists()
    run(f"contacts whose.npz --scene {FLOOR} --out plan.json --robot g1")
    assert read_plan("plan.json").feasible


def test_another_robot_is_refused(here, capsys) -> None:
    said = refused(f"label g1.npz --scene {FLOOR} --robot talos --out labels")
    assert "g1.npz was walked by robot 'g1', with its root 0.7 m above ground" in said
    said = refused(f"label talos.npz g1.npz --scene {FLOOR} --out labels")
    assert "talos.npz is of talos, and g1.npz of g1: label the paths of each robot" in said
    with pytest.raises(InputError, match=r"g1\.npz was walked by robot 'g1'"):
        followed_by(Path("plan.json"), None, Path("g1.npz"), Path(FLOOR), 0, "talos")
    assert followed_by(Path("p.json"), None, Path("g1.npz"), Path(FLOOR), 0, None).robot == "g1"


def test_plans_and_paths_are_counted_apart(here, capsys) -> None:
    paths = [straight(0.6), straight(0.6, y=0.3), straight(0.6, y=-0.3)]
    paths[2].valid[-1] = False
    write_guide_paths("walks.npz", paths, ["reached", "stopped", "invalid"], robot="talos")
    run(f"label walks.npz --scene {FLOOR} --planner mip --out labels --processes 1")
    said = capsys.readouterr().out
    assert "labels: 3 of 3 guide paths succeed with the mip planner (1 reached their goal," in said
    assert "1 ended invalid, 1 stopped before their goal)" in said
    for query, words in ((0, "reaches its goal"), (1, "stops before its"), (2, "ends invalid")):
        run(f"contacts walks.npz --query {query} --scene {FLOOR} --out plan.json")
        assert f"the guide path {'' if query == 0 else 'itself '}{words}" in capsys.readouterr().out
    assert read_plan("plan.json").guide_ended == "invalid"
    assert read_plan("plan.json").feasible


def test_a_g1_path_without_a_robot_is_caught(shared, capsys, tmp_path) -> None:
    cases = shared / "cases"
    if not cases.is_dir():
        pytest.skip("needs ../shared/cases")
    line = f"label {cases}/guide_of_g1.npz --scene {cases}/base.stl --planner mip"
    said = refused(f"{line} --out {tmp_path}/l")
    assert "does not say whose path it is, and its root is 0.59 m above the ground" in said
    run(f"{line} --out {tmp_path}/l --robot g1 --processes 1")
    assert "1 of 1 guide paths succeed" in capsys.readouterr().out


def test_floors_that_are_not_below_do_not_count() -> None:
    scene = flat()
    scene.surfaces["roof"] = floor(-2, 8, -2, 2, 2.5)
    np.testing.assert_allclose(heights_above_ground(scene, np.array([[0.0, 0.0, 0.9]])), 0.9)
