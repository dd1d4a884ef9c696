"""The trunk along a guide path, which MIP and SL1M check before they place feet."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.conditions import exact_collision
from jaxleas.contacts import read_plan
from jaxleas.contacts.checking import NotCertifiedError
from jaxleas.contacts.trunk import trunk_collision
from jaxleas.guide import write_guide_paths
from jaxleas.labels import judge
from jaxleas.robots import load_robot, load_talos
from jaxleas.terrain import Scene, load_scene, write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, floor, stairs, straight, wall

BOTH = pytest.mark.parametrize("planner", ["mip", "sl1m"])
SHEET = np.array([[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 1.0, 1.5], [2.0, -1.0, 1.5]])
"""A wall without thickness."""


def slow_twin(robot, polygon, path) -> int | None:
    """Return the first configuration at which points of a polygon lie in a trunk box."""
    (a, b, _, d), grid = polygon, np.linspace(0.0, 1.0, 120)
    u, v = np.meshgrid(grid, grid)
    points = a + u.reshape(-1, 1) * (b - a) + v.reshape(-1, 1) * (d - a)
    for index, (root, yaw) in enumerate(zip(path.position, path.yaw, strict=True)):
        cosine, sine = np.cos(yaw), np.sin(yaw)
        local = (points - root) @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
        for box in robot.trunk:
            if ((local >= box.low) & (local <= box.high)).all(axis=1).any():
                return index
    return None


@pytest.mark.parametrize("seed", range(4))
def test_the_first_collision_is_that_of_a_slow_twin(seed) -> None:
    robot = load_talos()
    rng = np.random.default_rng(seed)
    path = straight(2.5, y=rng.uniform(-1.4, 1.4), yaw=rng.uniform(-0.3, 0.3))
    scene = Scene(flat().surfaces, {"sheet": SHEET})
    found, expected = trunk_collision(robot, scene, path), slow_twin(robot, SHEET, path)
    assert (found is None) == (expected is None)
    if found is not None and expected is not None:
        assert abs(found.index - expected) <= 1  # a configuration is 2 cm, the twin's points 1.7 cm
        assert not exact_collision(robot, [SHEET], path.position, path.yaw)[found.index]
        assert "the trunk touches 'sheet' at configuration" in found.sentence


@BOTH
def test_a_wall_across_the_path_stops_it(planner) -> None:
    path, clear = straight(2.5), straight(1.0)
    scene = Scene(flat().surfaces, {"sheet": SHEET})
    verdict, free = judge(planner, scene, [path, clear], robot="talos")
    assert free.success
    assert (verdict.decided, verdict.success, verdict.cause) == (True, False, "collision")
    reach = load_talos().trunk[0].high[0]
    assert 2.0 - reach - 0.02 - 14 * 0.02 <= path.position[verdict.last_index, 0] < 2.0 - reach
    assert verdict.last_index % 14 == 0
    assert verdict.steps == verdict.last_index // 14


@BOTH
def test_the_trunk_in_a_wall_at_the_start_reaches_nothing(planner) -> None:
    (verdict,) = judge(planner, wall(), [straight(1.0, start=2.1)], robot="talos")
    assert (verdict.cause, verdict.last_index, verdict.steps) == ("collision", -1, 0)
    (verdict,) = judge(
        planner, wall(), [straight(0.3, start=1.7)], robot="talos"
    )  # before the first step's end
    assert (verdict.cause, verdict.last_index, verdict.steps) == ("collision", 0, 0)


@BOTH
def test_verdicts_without_obstacles_are_those_of_before(planner, monkeypatch) -> None:
    """Surfaces that feet may touch do not block, wherever the trunk is."""
    paths = [straight(3.0, climbing=True), straight(2.0, height=0.35)]
    assert not exact_collision(
        load_talos(), stairs().polygons, paths[1].position, paths[1].yaw
    ).all()
    found = judge(planner, stairs(), paths, robot="talos")
    assert all(trunk_collision(load_talos(), stairs(), each) is None for each in paths)
    monkeypatch.setattr("jaxleas.contacts.programs.judging.trunk_collision", lambda *given: None)
    for one, other in zip(found, judge(planner, stairs(), paths, robot="talos"), strict=True):
        assert (one.success, one.last_index, one.cause) == (
            other.success,
            other.last_index,
            other.cause,
        )


def test_walls_for_palms_and_ceilings_block() -> None:
    path = straight(2.5)
    leaning = {"wall": SHEET, "floor": floor(-2, 8, -2, 2)}
    assert trunk_collision(load_talos(), Scene(leaning), path) is not None
    low = {"roof": floor(1.0, 3.0, -1.0, 1.0, 1.2)[::-1], "floor": floor(-2, 8, -2, 2)}
    assert trunk_collision(load_talos(), Scene(low), path) is not None
    low["roof"] = floor(1.0, 3.0, -1.0, 1.0, 1.6)[::-1]
    assert trunk_collision(load_talos(), Scene(low), path) is None


def test_contacts_say_it_with_a_cause(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_scene("scene.json", Scene(flat().surfaces, {"sheet": SHEET}))
    write_guide_paths(
        "walks.npz", [straight(2.5), straight(1.0)], ["reached", "reached"], robot="talos"
    )
    for planner in ("mip", "sl1m", "sampling"):
        cli.run(f"contacts walks.npz --scene scene.json --out p.json --planner {planner}".split())
        plan = read_plan("p.json")
        assert (plan.feasible, plan.cause, plan.guide_ended) == (False, "collision", "reached")
        assert (plan.last_feasible_step or 0) > 1
    capsys.readouterr()
    line = "contacts walks.npz --scene scene.json --out p.json --query 1 --problem problem.json"
    cli.run(line.split())
    assert read_plan("p.json").feasible
    assert "reaches its goal" in capsys.readouterr().out


def test_check_judges_the_trunk_where_it_is_given_the_path(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_scene("scene.json", Scene(flat().surfaces, {"sheet": SHEET}))
    paths = [straight(1.0), straight(2.5)]
    write_guide_paths("walks.npz", paths, ["reached", "reached"], robot="talos")
    line = "contacts walks.npz --scene scene.json --out p.json --problem problem.json"
    cli.run(line.split())
    capsys.readouterr()
    check = "check p.json problem.json"
    cli.run(check.split())
    assert "obstacles of the trunk were not looked at" in capsys.readouterr().out
    cli.run(f"{check} --guide walks.npz --scene scene.json".split())
    assert "the trunk touches nothing along the guide path" in capsys.readouterr().out
    with pytest.raises(NotCertifiedError, match="the trunk touches 'sheet'"):
        cli.run(f"{check} --guide walks.npz --scene scene.json --query 1".split())
    with pytest.raises(InputError, match="--guide and --scene belong together"):
        cli.run(f"{check} --guide walks.npz".split())


def test_other_robots_have_their_own_trunk() -> None:
    low = Scene({"floor": floor(-2, 8, -2, 2)}, {"beam": floor(1.5, 1.7, -1, 1, 1.35)})
    assert trunk_collision(load_talos(), low, straight(2.0, height=0.95)) is not None
    assert trunk_collision(load_robot("g1"), low, straight(2.0, height=0.70)) is None


def test_a_wall_without_thickness_of_a_mesh_stands_in_the_way(shared) -> None:
    mesh = shared / "cases" / "sheet_wall.stl"
    if not mesh.is_file():
        pytest.skip("needs ../shared/cases")
    (query,) = json.loads((mesh.parent / "q_wall.json").read_text())
    x, y, z = query["position"]
    path = straight(abs(query["goal"][0] - x), height=z, y=y, start=min(x, query["goal"][0]))
    (verdict,) = judge("mip", load_scene(mesh), [path], robot="talos")
    assert (verdict.decided, verdict.success, verdict.cause) == (True, False, "collision")
