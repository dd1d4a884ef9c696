import numpy as np
import pytest

from jaxleas.contacts import Stepping
from jaxleas.contacts.from_guide import nearest_below, problem_from_guide
from jaxleas.contacts.guide_file import read_guide_path
from jaxleas.contacts.problem import ContactProblem, Step
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.contacts.surfaces import make_surface
from jaxleas.files import write_npz
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, InputError
from tests.contacts.worlds import rectangle


def straight(length: float, step: float = 0.02, yaw: float = 0.0, start=(0.0, 0.0, 0.95)):
    count = round(length / step) + 1
    along = np.arange(count)[:, None] * step * np.array([np.cos(yaw), np.sin(yaw), 0.0])
    return GuidePath(
        time=np.arange(count) * 0.2,
        position=np.array(start) + along,
        yaw=np.full(count, yaw),
        velocity=np.tile(along[min(1, count - 1)] / 0.2, (count, 1)),
        valid=np.ones(count, bool),
    )


def scene(**surfaces) -> Scene:
    return Scene({name: np.array(each, float) for name, each in surfaces.items()})


def allowed(made: ContactProblem, phase: Step) -> set[str]:
    """Return the scene's surfaces of which a part is a candidate."""
    return {made.whole(name) for name in phase.candidates}


FLOOR = scene(floor=rectangle(-1, 5, -1, 1))


def test_one_step_for_each_kept_configuration() -> None:
    made = problem_from_guide(straight(2.0), FLOOR, "talos", Stepping(every=10))
    assert len(made) == 10
    assert [phase.foot for phase in made.steps] == ["LF", "RF"] * 5
    np.testing.assert_allclose([p.root[0] for p in made.steps], np.arange(1, 11) * 0.2)
    assert [allowed(made, phase) for phase in made.steps] == [{"floor"}] * 10
    for foot, side in (("LF", 0.0848), ("RF", -0.0848)):
        np.testing.assert_allclose(made.initial[foot].position, [0.0, side, 0.0], atol=1e-12)


def test_the_guides_last_configuration_is_always_kept() -> None:
    made = problem_from_guide(straight(2.1), FLOOR, "talos", Stepping(every=20))
    assert len(made) == 6
    assert made.steps[-1].root[0] == pytest.approx(2.1)


@pytest.mark.parametrize("yaw", [0.0, 1.2, np.pi / 4])
def test_the_window_turns_with_the_root(yaw: float) -> None:
    """A patch just inside the window's corner, and one just outside its side."""
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    patch = np.array(rectangle(-0.02, 0.02, -0.02, 0.02))
    goal = np.array([0.28, 0.0, 0.0])
    made = problem_from_guide(
        straight(0.28, yaw=yaw, start=(0, 0, 0.95)),
        Scene(
            {
                "floor": np.array(rectangle(-1, 1, -1, 1)),
                "inside": (patch + goal + [0.37, 0.37, 0.01]) @ turn.T,
                "outside": (patch + goal + [0.43, 0.0, 0.01]) @ turn.T,
            }
        ),
        "talos",
    )
    assert allowed(made, made.steps[-1]) == {"floor", "inside"}


@pytest.mark.parametrize("yaw", [0.0, 1.2])
def test_a_candidate_is_what_lies_in_the_window(yaw: float) -> None:
    turn = np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
    small = np.array(rectangle(0.26, 0.30, -0.02, 0.02, 0.01)) @ turn.T
    strip = np.array(rectangle(-3.0, 3.0, -0.2, 3.0)) @ turn.T
    guide = straight(0.56, yaw=yaw)
    made = problem_from_guide(guide, Scene({"strip": strip, "small": small}), "talos")
    assert set(made.whole_surfaces) == {"strip", "small"}
    assert made.steps[0].candidates[0] == "small", "all of it: its own name"
    for index, phase in enumerate(made.steps):
        (part,) = [made.surfaces[n].vertices for n in phase.candidates if made.whole(n) == "strip"]
        local = (part - phase.root) @ turn
        np.testing.assert_allclose(local[:, :2].min(axis=0), [-0.4, -0.2], atol=1e-9)
        np.testing.assert_allclose(local[:, :2].max(axis=0), [0.4, 0.4], atol=1e-9)
        assert f"strip@{index}" in phase.candidates
    free = made.without_guide()
    assert set(free.steps[0].candidates) == {"strip", "small"}
    assert free.steps[-1].candidates == made.steps[-1].candidates


def test_the_window_holds_the_feet_near_the_guide() -> None:
    """The only step lands 0.43 m beside the root: out of a window of 0.8 m, in one of 1 m."""
    aside = scene(
        start=rectangle(-0.2, 0.15, -0.2, 0.2),
        left=rectangle(0.22, 0.6, 0.43, 0.8),
        ahead=rectangle(0.9, 1.2, -0.3, 0.3),
    )
    guide = straight(0.6)
    assert plan_mip(
        problem_from_guide(guide, aside, "talos", Stepping(every=30, window=1.0))
    ).feasible
    plan = plan_mip(problem_from_guide(guide, aside, "talos", Stepping(every=30, window=0.8)))
    assert (plan.status, plan.last_feasible_step) == ("infeasible", -1)
    assert "LF onto 'ahead'" in plan.reason
    assert "which is not among its candidates" in plan.reason


def test_a_surface_named_like_a_part_is_left_alone() -> None:
    ground = np.array(rectangle(-1, 5, -1, 1), float)
    made = problem_from_guide(
        straight(0.28), Scene({"a": ground, "a@0": ground - [0, 0, 0.1]}), "talos"
    )
    assert set(made.whole_surfaces) == {"a", "a@0"}
    assert {made.whole(name) for name in made.steps[0].candidates} == {"a", "a@0"}


def test_rom_candidates_are_the_moving_legs() -> None:
    sides = scene(
        floor=rectangle(-1, 3, -0.1, 0.1),
        left=rectangle(-1, 3, 0.12, 0.3),
        right=rectangle(-1, 3, -0.3, -0.12),
    )
    made = problem_from_guide(straight(0.6), sides, "talos", Stepping(candidates="rom"))
    for phase in made.steps:
        own, other = ("left", "right") if phase.foot == "LF" else ("right", "left")
        assert own in allowed(made, phase)
        assert other not in allowed(made, phase)


def test_a_walk_over_the_floor_can_be_planned_and_a_gap_cannot() -> None:
    assert plan_mip(problem_from_guide(straight(3.0, 0.016), FLOOR, "talos")).feasible
    gap = scene(a=rectangle(-1, 1, -1, 1), b=rectangle(1.9, 5, -1, 1))
    plan = plan_mip(problem_from_guide(straight(3.0, 0.016), gap, "talos"))
    assert plan.status == "infeasible"
    assert plan.last_feasible_step is not None
    assert "first step that cannot be made" in plan.reason


@pytest.mark.parametrize(
    ("guide", "options", "words"),
    [
        (straight(9.0), {}, "leaves the scene: around configuration 28[0-9]"),
        (straight(1.0, start=(0, 5, 0.95)), {}, "starts where LF cannot stand"),
        (straight(1.0, start=(0, 0, 2.5)), {}, "starts where LF cannot stand"),
        (straight(0.0), {}, "1 configurations; a step needs at least 2"),
        (straight(1.0, start=(0, np.nan, 0.95)), {}, "not finite"),
        (straight(1.0), {"every": 0}, "every 0 must be at least 1"),
        (straight(1.0), {"window": 0.0}, "window 0.0"),
        (straight(1.0), {"robot": "spot"}, "no robot 'spot'"),
        (straight(1.0), {"first_foot": "left"}, "LF or RF"),
    ],
)
def test_a_mistake_is_one_sentence(guide: GuidePath, options: dict, words: str) -> None:
    robot = options.get("robot", "talos")
    stated = {name: each for name, each in options.items() if name != "robot"}
    with pytest.raises(InputError, match=words):
        problem_from_guide(guide, FLOOR, robot, Stepping(**stated))


def test_the_nearest_point_below() -> None:
    slope = make_surface(np.array([[0, 0, 0], [1, 0, 0.2], [1, 1, 0.2], [0, 1, 0]], float), "s")
    rng = np.random.default_rng(1)
    shares = rng.uniform(size=(4000, 2))
    inside = np.column_stack([shares, 0.2 * shares[:, 0]])
    for place in rng.uniform(-1, 2, size=(20, 3)):
        point, aside = nearest_below(slope, place)
        assert float(slope.distance(point)) < 1e-9
        apart = np.linalg.norm(inside[:, :2] - place[:2], axis=1).min()
        assert aside <= apart + 1e-9
        assert aside >= apart - 0.05


def test_a_guide_file_may_hold_several_paths(tmp_path) -> None:
    one, two = straight(1.0), straight(0.5, yaw=0.3)
    columns = {
        name: np.concatenate([getattr(one, name), getattr(two, name)])
        for name in ("time", "position", "yaw", "velocity", "valid")
    }
    owner = np.repeat([0, 1], [len(one), len(two)])
    write_npz(tmp_path / "g.npz", **columns, query=owner)
    assert len(read_guide_path(tmp_path / "g.npz")) == len(one)
    np.testing.assert_allclose(read_guide_path(tmp_path / "g.npz", 1).position, two.position)
    with pytest.raises(InputError, match="no path 2; it holds paths 0 to 1"):
        read_guide_path(tmp_path / "g.npz", 2)
    columns["yaw"][3] = np.nan
    write_npz(tmp_path / "bad.npz", **columns)
    with pytest.raises(InputError, match="yaw holds a number that is not finite"):
        read_guide_path(tmp_path / "bad.npz")
