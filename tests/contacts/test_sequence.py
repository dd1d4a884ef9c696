"""Contact plans in time: laws of phases and schedules, the files, and those who read them."""

import csv
import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import plan_mip, read_plan, stances_of
from jaxleas.contacts.sequence.from_plan import sequence_of_steps
from jaxleas.contacts.sequence.schedule import schedule_of
from jaxleas.contacts.sequence.timing import SHORTEST, apart
from jaxleas.contacts.sequence.values import ContactSequence, Landing
from jaxleas.files import write_json, write_npz
from jaxleas.robots import RecordedRobot, load_robot
from jaxleas.types import Contact, InputError, Pose, Stance
from tests.contacts.test_from_guide import straight
from tests.contacts.worlds import problem, rectangle, stones


def run(line: str) -> None:
    cli.run(line.split())


ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def sequence() -> ContactSequence:
    asked = problem(stones(0.1, rise=0.05))
    return sequence_of_steps(asked, plan_mip(asked), np.array([1.0, 2.0, 2.5, 4.0]), 0.25)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A guide path over a floor, and plans of two planners along it."""
    monkeypatch.chdir(tmp_path)
    guide = straight(0.8, 0.016)
    names = ("time", "position", "yaw", "velocity", "valid")
    write_npz("guide.npz", **{name: getattr(guide, name) for name in names})
    write_json("scene.json", {"surfaces": {"floor": rectangle(-1, 5, -1, 1)}})
    run("contacts guide.npz --scene scene.json --out plan.json --problem problem.json")
    return tmp_path


def test_phases_are_the_stances_of_the_plan_with_one_effector_lifted_between(sequence) -> None:
    asked = problem(stones(0.1, rise=0.05))
    stances = stances_of(asked, plan_mip(asked))
    phases = sequence.phases
    assert len(phases) == 2 * len(asked) + 1
    assert sum(each.duration for each in phases[:-1]) == pytest.approx(4.0)
    assert [each.duration for each in phases[:4]] == pytest.approx([0.25, 0.75, 0.25, 0.75])
    for number, (before, step) in enumerate(zip(stances, asked.steps, strict=False)):
        standing, moving = phases[2 * number].stance, phases[2 * number + 1].stance
        assert standing.changed(before) == ()
        assert standing.changed(moving) == (step.foot,)
        assert moving.changed(phases[2 * number + 2].stance) == (step.foot,)
    assert phases[-1].stance.changed(stances[-1]) == ()


def test_a_schedule_is_the_phases_at_even_times(sequence) -> None:
    interval, height = 0.04, 0.1
    found = schedule_of(sequence, interval, height)
    ends = np.cumsum([each.duration for each in sequence.phases])
    assert found.time[-1] == pytest.approx(ends[-1], abs=interval)
    for node, time in enumerate(found.time):
        if np.abs(ends - time).min() < 1e-6:
            continue  # at a switch
        stance = sequence.phases[int(np.searchsorted(ends, time))].stance
        touching = {name for at, name in enumerate(sequence.effectors) if found.contact[node, at]}
        assert touching == set(stance.contacts)
        for at, name in enumerate(sequence.effectors):
            if name in stance:
                np.testing.assert_array_equal(found.position[node, at], stance[name].pose.position)


def test_swings_are_smooth_and_pass_above_both_contacts(sequence) -> None:
    height = 0.1
    found = schedule_of(sequence, 0.002, height)
    speed = np.linalg.norm(np.diff(found.position, axis=0), axis=-1) / 0.002
    assert speed.max() < 5.0
    assert np.abs(np.diff(speed, axis=0)).max() < 0.1  # no jump of velocity, at the ends neither
    start = 0.0
    for number, phase in enumerate(sequence.phases):
        half_way = round((start + 0.5 * phase.duration) / 0.002)
        start += phase.duration
        if number % 2 == 0:
            continue
        contact = sequence.landings[number // 2].contact
        at = sequence.effectors.index(contact.effector)
        before = sequence.phases[number - 1].stance[contact.effector]
        higher = max(before.pose.position[2], contact.pose.position[2])
        assert found.position[half_way, at, 2] == pytest.approx(higher + height, abs=5e-4)


def test_corners_of_a_sole_lie_around_its_middle(sequence) -> None:
    found = schedule_of(sequence, 0.05, 0.1)
    half_sizes = np.array(list(sequence.half_sizes.values()))
    corners = found.corners(half_sizes)
    np.testing.assert_allclose(corners.mean(axis=2), found.position, atol=1e-12)
    front_left = corners[:, 0, 0] - found.position[:, 0]
    np.testing.assert_allclose(front_left[0, :2], half_sizes[0], atol=1e-12)


def test_any_effector_may_make_its_first_contact_late() -> None:
    foot = Contact("A", "floor", Pose.from_yaw(np.zeros(3), 0.3))
    wall = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
    palm = Contact("palm", "wall", Pose.from_matrix(np.array([0.5, 0.0, 1.0]), wall))
    sizes = {"A": (0.0, 0.0), "palm": (0.05, 0.05), "C": (0.1, 0.05)}
    other = Contact("C", "floor", Pose.from_yaw(np.array([0.0, 0.2, 0.0]), 0.0))
    made = ContactSequence(
        "any", sizes, Stance.of([foot, other]), (Landing(palm, 1.0), Landing(foot, 2.0)), 0.5
    )
    assert [len(each.stance) for each in made.phases] == [2, 2, 3, 2, 3]
    found = schedule_of(made, 0.1, 0.05)
    assert np.isnan(found.position[:10, 1]).all()
    assert not found.contact[:10, 1].any()
    assert found.contact[10:, 1].all()


def test_landings_at_one_configuration_are_spread(caplog) -> None:
    moved = apart("plan.json", np.array([0.0, 0.0, 0.05, 1.0, 1.0]))
    np.testing.assert_allclose(moved, [SHORTEST, 2 * SHORTEST, 3 * SHORTEST, 1.0, 1.0 + SHORTEST])
    assert "spread: up to 0.25 s later" in caplog.text
    caplog.clear()
    times = np.array([0.5, 1.0, 1.1])
    np.testing.assert_array_equal(apart("plan.json", times), times)
    assert not caplog.text


def test_footsteps_are_a_table_of_x_y_yaw(folder, capsys) -> None:
    run("contacts export plan.json problem.json --guide guide.npz --out new/a.csv")
    plan = read_plan("plan.json")
    with Path("new/a.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert plan.footholds is not None
    assert [each["effector"] for each in rows[:4]] == ["LF", "RF", "LF", "RF"]
    assert [int(each["step"]) for each in rows] == [0, 0, *range(1, len(plan.footholds) + 1)]
    steps = np.array([[float(row[name]) for name in "xyz"] for row in rows[2:]])
    np.testing.assert_allclose(steps, plan.footholds, atol=1e-6)
    assert {row["surface"] for row in rows} == {"floor"}  # not its parts
    table = np.loadtxt("new/a.csv", delimiter=",", skiprows=1, usecols=(0, 1, 2))
    assert table.shape == (len(rows), 3)
    guide = np.load("guide.npz")
    times = [float(row["time"]) for row in rows[2:]]
    assert times == pytest.approx(guide["time"][[14, 28, 42, 50]])
    assert f"{len(plan.footholds)} footsteps" in capsys.readouterr().out


def test_phases_say_poses_and_times_of_all_contacts(folder) -> None:
    line = "contacts export plan.json problem.json --out phases.json --step-time 0.8"
    cli.run([*line.split(), "--standing", "0.25"])
    content = json.loads(Path("phases.json").read_text())
    plan = read_plan("plan.json")
    assert plan.footholds is not None
    assert content["robot"] == "talos"
    assert content["effectors"]["LF"]["link"] == "leg_left_6_link"
    ends = np.cumsum([each["duration"] for each in content["phases"]])
    assert content["switch_times"] == pytest.approx(ends[:-1])
    np.testing.assert_allclose([each["start"] for each in content["phases"][1:]], ends[:-1])
    landings = [each["landing"] for each in content["phases"] if each["landing"]]
    np.testing.assert_allclose([each["position"] for each in landings], plan.footholds)
    assert [sorted(each["contacts"]) for each in content["phases"][:3]] == [
        ["LF", "RF"], ["RF"], ["LF", "RF"],
    ]  # fmt: skip


def test_a_schedule_has_the_arrays_of_mpx(folder) -> None:
    """Its reference generator makes [N+1, contacts] and [N+1, 3 contacts], contact by contact."""
    line = "contacts export plan.json problem.json --guide guide.npz --out nodes.npz"
    cli.run([*line.split(), "--interval", "0.05"])
    arrays = np.load("nodes.npz", allow_pickle=False)
    nodes = len(arrays["time"])
    assert list(arrays["effectors"]) == ["LF", "RF"]
    assert arrays["contact_sequence"].shape == (nodes, 2)
    assert set(np.unique(arrays["contact_sequence"])) == {0.0, 1.0}
    assert arrays["foot_ref"].shape == (nodes, 6)
    assert arrays["corner_contact_sequence"].shape == (nodes, 8)
    assert arrays["corner_foot_ref"].shape == (nodes, 24)
    corners = arrays["corner_foot_ref"].reshape(nodes, 2, 4, 3)
    np.testing.assert_allclose(
        corners.mean(axis=2).reshape(nodes, 6), arrays["foot_ref"], atol=1e-12
    )
    guide = np.load("guide.npz")
    within = arrays["time"] <= guide["time"][-1]
    for axis in range(3):
        wanted = np.interp(arrays["time"][within], guide["time"], guide["position"][:, axis])
        np.testing.assert_allclose(arrays["p_ref"][within, axis], wanted, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(arrays["quat_ref"], axis=1), 1.0)


def test_a_plan_of_postures_needs_its_surfaces(folder) -> None:
    run("contacts guide.npz --scene scene.json --planner sampling --out s.json")
    with pytest.raises(InputError, match=r"say the surfaces that it stands on, with --scene"):
        run("contacts export s.json --out s.csv")
    run("contacts export s.json --scene scene.json --guide guide.npz --out s.csv")
    with Path("s.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    plan = read_plan("s.json")
    assert plan.postures is not None
    assert plan.footholds is not None
    made = [each for each in plan.postures if each.moved]
    assert [row["effector"] for row in rows[2:]] == [each.moved for each in made]
    guide = np.load("guide.npz")
    assert [float(row["time"]) for row in rows[2:]] == pytest.approx(
        [guide["time"][each.configuration] for each in made]
    )


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("plan.json --out a.csv", "say which problem it answers"),
        ("plan.json problem.json --out a.yaml", r"footsteps \(\.csv\), phases"),
        ("plan.json problem.json --out a.csv --step-time 0", "--step-time 0 must be a positive"),
        ("plan.json problem.json --out a.csv --standing 1", "standing 1 must lie between 0 and 1"),
        ("plan.json problem.json --out a.npz --interval nan", "--interval nan must be"),
        ("plan.json problem.json --out a.npz --interval 1e-9", "more than 1000000"),
        ("plan.json problem.json --out a.npz --step-height -1", "--step-height -1 must be"),
        ("plan.json problem.json --guide other.npz --out a.csv", "made of another one"),
        ("none.json problem.json --out a.csv", "'infeasible' and has no footholds"),
        ("scene.json problem.json --out a.csv", "is not a contact plan"),
    ],
)
def test_a_mistake_is_one_sentence_and_nothing_is_written(folder, line, reason) -> None:
    other = straight(2.0, 0.03)
    names = ("time", "position", "yaw", "velocity", "valid")
    write_npz("other.npz", **{name: getattr(other, name) for name in names})
    plan = json.loads(Path("plan.json").read_text())
    nothing = {"feasible": False, "status": "infeasible", "surfaces": [], "footholds": []}
    write_json("none.json", {**plan, **nothing, "com": None})
    with pytest.raises(InputError, match=reason):
        cli.run(["contacts", "export", *line.split()])
    assert not list(Path().glob("a.*"))


def test_crocoddyl_makes_a_shooting_problem_of_the_phases(folder) -> None:
    crocoddyl = pytest.importorskip("crocoddyl", reason="needs crocoddyl")
    data = pytest.importorskip("example_robot_data", reason="needs example-robot-data")
    run("contacts export plan.json problem.json --step-time 0.8 --out phases.json")
    spec = importlib.util.spec_from_file_location("walk", ROOT / "examples" / "crocoddyl_walk.py")
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    robot = data.load("talos_legs")
    content = json.loads(Path("phases.json").read_text())
    walk = example.Walk(robot.model, robot.q0, content, 0.1)
    made = walk.problem()
    assert isinstance(made, crocoddyl.ShootingProblem)
    states = [walk.start] * (made.T + 1)
    assert np.isfinite(made.calc(states, list(made.quasiStatic(states[:-1]))))


def recorded(folder: Path, robot: str) -> None:
    """Write the guide path of the folder again, with the robot that walked it."""
    with np.load(folder / "guide.npz") as arrays:
        write_npz(folder / "guide.npz", **arrays, **RecordedRobot.of(robot).to_arrays())


def test_a_guide_path_of_another_robot_is_refused(folder) -> None:
    recorded(folder, "g1")
    with pytest.raises(InputError, match=r"guide\.npz was walked by robot 'g1'.* talos walks"):
        run("contacts export plan.json problem.json --guide guide.npz --out steps.csv")
    assert not (folder / "steps.csv").exists()


def test_postures_are_of_the_robot_that_walked_the_guide_path(folder, monkeypatch) -> None:
    run("contacts guide.npz --scene scene.json --planner sampling --out s.json")
    recorded(folder, "g1")
    robots = []
    monkeypatch.setattr(
        "jaxleas.contacts.sequence.commands.load_robot",
        lambda name: robots.append(name) or load_robot("talos"),
    )
    run("contacts export s.json --scene scene.json --guide guide.npz --out steps.csv")
    assert robots == ["g1"]


def test_options_of_a_terrain_apply_to_the_scene_alone(folder) -> None:
    with pytest.raises(InputError, match="options of a terrain file were given without --scene"):
        run("contacts export plan.json problem.json --crop 0 1 0 1 --out steps.csv")
    run("contacts guide.npz --scene scene.json --planner sampling --out s.json")
    with pytest.raises(InputError, match=r"--min-area does not apply to scene\.json"):
        run("contacts export s.json --scene scene.json --min-area 1 --out steps.csv")
