"""`jaxleas gait plan` on the command line: what works, what is refused, and exit codes."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.gaits.plan_command import NoGaitError
from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.types import InputError
from tests.gaits.worlds import platform, with_gap


@pytest.fixture
def command(tmp_path):
    write_height_map(tmp_path / "level.npz", platform())
    terrain, out = str(tmp_path / "level.npz"), str(tmp_path / "plan.json")
    return [
        *("gait", "plan", "search", "--terrain", terrain, "--out", out, "--width", "2"),
        *("--start", "0.5,2,0", "--goal", "1.3,2"),
    ]


def test_a_plan_is_written_with_its_certificate(command, tmp_path, capsys):
    cli.run(command)
    plan = json.loads((tmp_path / "plan.json").read_text())
    assert plan["ending"] == "reached"
    assert plan["certificate"]["holds"]
    assert np.hypot(*(np.array(plan["phases"][-1]["com"][:2]) - plan["goal"])) < 0.5
    said = capsys.readouterr().out
    assert "the goal is reached" in said
    assert "HiGHS confirms" in said


def test_the_robot_faces_the_goal_where_no_heading_is_stated(command, tmp_path):
    cli.run([*command, "--start", "1.5,2", "--goal", "0.7,2"])
    yaw = json.loads((tmp_path / "plan.json").read_text())["phases"][0]["yaw"]
    assert abs(yaw) == pytest.approx(np.pi, abs=1e-3)


def test_a_goal_that_is_not_reached_is_an_answer_and_the_part_is_kept(command, tmp_path):
    with pytest.raises(NoGaitError, match="plan would be too long") as caught:
        cli.run([*command, "--goal", "2.3,2", "--phases", "2"])
    assert caught.value.exit_code == 1
    assert len(json.loads((tmp_path / "plan.json").read_text())["times"]) <= 2


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--goal", "9,2"], "outside the terrain: x from"),
        (["--goal", "here"], "--goal is 'here'"),
        (["--width", "0"], "--width 0"),
        (["--phases", "0"], "--phases 0"),
        (["--out", "plan.txt"], "must end in .json"),
        (["--start", "-0.3,2,0"], "foot L. finds no safe place"),
    ],
)
def test_bad_input_is_refused_and_nothing_written(command, tmp_path, options, message):
    with pytest.raises(InputError, match=message):
        cli.run([*command, *options])
    assert not (tmp_path / "plan.json").exists()


def test_a_goal_on_nothing_is_refused(command, tmp_path):
    write_height_map(tmp_path / "gap.npz", with_gap(0.4))
    with pytest.raises(InputError, match="on nothing"):
        cli.run([*command, "--terrain", str(tmp_path / "gap.npz"), "--goal", "1.0,2"])


def test_a_start_astride_a_step_says_which_foot_is_out_of_reach(command, tmp_path):
    level = platform()
    heights = level.heights.copy()
    heights[:, 60:] += 0.4
    write_height_map(tmp_path / "step.npz", HeightMap(heights, level.resolution, level.origin))
    with pytest.raises(InputError, match=r"foot .F is out of reach by \d+\.\d cm"):
        cli.run([*command, "--terrain", str(tmp_path / "step.npz"), "--start", "0.7,2,0"])


def test_coarse_cells_are_refused(command, tmp_path):
    coarse = HeightMap(np.zeros((30, 60), np.float32), 0.1, (-1.0, 0.0))
    write_height_map(tmp_path / "coarse.npz", coarse)
    with pytest.raises(InputError, match="cells of 10 cm"):
        cli.run([*command, "--terrain", str(tmp_path / "coarse.npz")])


def test_a_policy_of_another_task_is_refused(command):
    with pytest.raises(InputError, match="policy of the task steering"):
        cli.run([*command[:2], "pretrained/leas_p1.npz", *command[3:]])


@pytest.mark.slow
def test_the_shipped_policy_crosses_a_gap_and_its_plan_is_certified(command, tmp_path, capsys):
    pytest.importorskip("numba")
    write_height_map(tmp_path / "gap.npz", with_gap(0.16, length=4.0))
    asked = ["--terrain", str(tmp_path / "gap.npz"), "--start", "0,2,0", "--goal", "2.2,2"]
    cli.run([*command[:2], "pretrained:gaits", *command[3:], *asked])
    plan = json.loads((tmp_path / "plan.json").read_text())
    assert plan["ending"] == "reached"
    assert plan["certificate"]["holds"]
    assert "pretrained:gaits" in plan["planner"]
