"""The sampling planner asked by a problem file: a guide path made of the phases' roots."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import problem_from_guide, read_plan, read_problem, write_problem
from jaxleas.contacts.guide_from_problem import guide_from_problem, scene_of_problem
from jaxleas.files import write_json
from jaxleas.types.errors import InputError
from tests.contacts.sampling.worlds import stairs, straight
from tests.contacts.worlds import problem, rectangle, stones


def run(line: str) -> None:
    cli.run(line.split())


def test_the_guide_goes_through_every_root() -> None:
    asked = problem_from_guide(straight(1.5, climbing=True), stairs(), "talos")
    guide = guide_from_problem(asked)
    for phase in asked.steps:
        apart = np.linalg.norm(guide.position - phase.root, axis=1)
        assert apart.min() < 1e-9
        assert guide.yaw[apart.argmin()] == pytest.approx(phase.yaw)
    steps = np.linalg.norm(np.diff(guide.position, axis=0), axis=1)
    assert 0.015 < steps.mean() <= steps.max() <= 0.02 + 1e-6
    np.testing.assert_allclose(guide.position[0], [0.5, 0.0, 0.9], atol=1e-6)
    assert (np.diff(guide.time) > 0).all()


def test_the_first_root_stays_within_the_robots_own_band() -> None:
    """G1's legs are 0.7 / 0.95 as long as Talos's, and so is what its root may differ by."""
    described = stones(0.1)
    for phase in described["phases"]:
        phase["root"] = [0.0, 0.0, 0.3]
    for name, lowest in (("talos", 0.95 - 0.1), ("g1", 0.7 - 0.1 * 0.7 / 0.95)):
        asked = replace(problem(described), robot=name)
        assert guide_from_problem(asked).position[0, 2] == pytest.approx(lowest)


def test_it_turns_the_short_way() -> None:
    described = stones(0.1)
    for index, phase in enumerate(described["phases"]):
        phase["root"] = [0.1 * index, 0.0, 0.95]
        phase["yaw"] = 3.1 if index % 2 else -3.1
    described["initial"]["LF"]["yaw"] = described["initial"]["RF"]["yaw"] = 3.1
    guide = guide_from_problem(problem(described))
    assert np.abs(np.diff(guide.yaw)).max() <= 0.05 + 1e-6
    assert np.ptp(guide.yaw) < 0.1


def test_walls_are_obstacles_and_parts_are_no_surfaces() -> None:
    described = stones(0.1)
    described["surfaces"]["wall"] = [[3, -1, 0], [3, 1, 0], [3, 1, 1], [3, -1, 1]]
    described["parts"] = {"stone_1": "stone_2"}
    scene = scene_of_problem(problem(described))
    assert set(scene.obstacles) == {"wall"}
    assert set(scene.surfaces) == {"start", "stone_0", "stone_2", "stone_3"}
    asked = problem(described)
    only = replace(asked, surfaces={"wall": asked.surfaces["wall"]}, parts={})
    with pytest.raises(InputError, match="no surface but walls"):
        scene_of_problem(only)


def test_from_problem_to_plan_to_check(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    write_problem(
        "stairs.json", problem_from_guide(straight(1.5, climbing=True), stairs(), "talos")
    )
    run("plan stairs.json --planner sampling --out plan.json --picture plan.png")
    assert "sampling: feasible" in capsys.readouterr().out
    plan = read_plan("plan.json")
    assert (
        plan.postures[-1].configuration == len(guide_from_problem(read_problem("stairs.json"))) - 1
    )
    run("check plan.json stairs.json")
    assert "is certified" in capsys.readouterr().out
    with pytest.raises(InputError, match="--cost is for mip, sl1m and astar"):
        run("plan stairs.json --planner sampling --out p.json --cost linear")


def test_without_roots_one_sentence(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_json("stones.json", stones(0.1))
    with pytest.raises(InputError, match=r"step 0 has no root.*jaxleas contacts GUIDE\.npz"):
        run("plan stones.json --planner sampling --out p.json")
    assert not (tmp_path / "p.json").exists()


def test_a_stop_says_why_each_foot_failed(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    described = stones(0.1)
    described["surfaces"] = {
        "start": rectangle(-1, 1, -1, 1),
        "goal": rectangle(2.5, 4, -1, 1),
    }
    for index, phase in enumerate(described["phases"]):
        phase["root"], phase["candidates"] = [1.0 + 0.5 * index, 0.0, 0.95], ["start", "goal"]
    write_json("gap.json", described)
    run("plan gap.json --planner sampling --out p.json --picture why.svg")
    said = capsys.readouterr().out
    assert "sampling: not_found" in said
    reason = read_plan("p.json").reason
    assert "; RF " in reason
    assert ": LF " in reason
    assert "place" in reason or "near no surface" in reason or "cannot" in reason
