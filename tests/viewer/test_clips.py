from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.plan import ContactPlan, write_plan
from jaxleas.contacts.problem_file import write_problem
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.guide import write_guide_paths
from jaxleas.robots import load_talos
from jaxleas.terrain import HeightMap
from jaxleas.types import GuidePath, InputError
from jaxleas.viewer.clips import (
    guide_clip,
    plan_clip,
    read_guide_clips,
    read_plan_clip,
    warn_of_height,
)
from jaxleas.viewer.playback import robot_to_draw
from tests.contacts.worlds import problem, stones


def straight(count: int = 5) -> GuidePath:
    time = 0.2 * np.arange(count)
    position = np.stack([time, 0 * time, 0.95 + 0 * time], axis=-1)
    yaw = np.linspace(3.0, 3.4, count)
    wrapped = (yaw + np.pi) % (2 * np.pi) - np.pi
    return GuidePath(time, position, wrapped, np.zeros((count, 3)), np.arange(count) < count - 1)


def test_a_guide_path_is_played_at_its_own_times():
    clip = guide_clip("path", straight())
    assert clip.duration == pytest.approx(0.8)
    pose, valid = clip.at(0.5)
    assert pose.position == pytest.approx([0.5, 0.0, 0.95])
    assert pose.yaw == pytest.approx(3.25 - 2 * np.pi)  # not the long way round
    assert valid
    assert not clip.at(0.8)[1]


def test_a_file_of_paths_becomes_one_clip_each(tmp_path):
    write_guide_paths(tmp_path / "paths.npz", [straight(), straight(3)], ["invalid", "reached"])
    clips = read_guide_clips(tmp_path / "paths.npz")
    assert [clip.name for clip in clips] == ["path 0 invalid", "path 1 reached"]
    assert [len(clip.time) for clip in clips] == [5, 3]


def test_guide_paths_name_the_robot_that_is_drawn(tmp_path):
    file = tmp_path / "paths.npz"
    write_guide_paths(file, [straight()], ["invalid"], robot="g1")
    assert robot_to_draw(read_guide_clips(file)).name == "g1"
    with pytest.raises(InputError, match=r"walked by robot 'g1', with its root 0\.7 m above"):
        read_guide_clips(file, "talos")


def test_a_path_at_another_height_is_drawn_with_a_warning(caplog):
    ground = HeightMap(np.zeros((50, 50), np.float32), 0.1, (-1.0, -1.0))
    path = straight()
    warn_of_height([guide_clip("path", path)], load_talos(), ground)
    assert not caplog.text
    path.position[:, 2] = 0.6
    warn_of_height([guide_clip("path", path)], load_talos(), ground)
    assert "talos is drawn, but its root is 0.60 m above the ground" in caplog.text


def test_a_plan_is_played_a_phase_a_second_and_feet_stand_until_they_move():
    asked = problem(stones(0.05))
    answer = plan_mip(asked)
    assert answer.feasible
    clip = plan_clip("stones", asked, answer)
    assert clip.at(0.0) is None  # no guide, no root
    assert clip.duration == len(asked)
    standing = [
        [each for each in clip.footholds if each.time <= t < each.until]
        for t in np.arange(0.5, clip.duration)
    ]
    assert all({each.effector for each in feet} == {"LF", "RF"} for feet in standing)
    assert all(len(feet) == 2 for feet in standing)
    landed = [each.pose.position for each in clip.footholds[2:]]
    np.testing.assert_allclose(landed, answer.footholds)


def test_a_plan_that_answers_another_problem_is_refused(tmp_path):
    asked = problem(stones(0.05))
    write_plan(tmp_path / "plan.json", plan_mip(asked))
    write_problem(tmp_path / "other.json", asked.prefix(1))
    with pytest.raises(InputError, match="another problem"):
        read_plan_clip(tmp_path / "plan.json", tmp_path / "other.json")


def test_an_infeasible_plan_shows_where_the_feet_stood():
    asked = problem(stones(0.05))
    clip = plan_clip("stones", asked, ContactPlan("mip", False, "infeasible", "why"))
    assert len(clip.footholds) == 2
    assert clip.duration == 0.0


def test_the_figure_is_of_the_robot_that_moves():
    asked = problem(stones(0.05))
    clips = [plan_clip("a", asked, plan_mip(asked)), guide_clip("path", straight())]
    assert robot_to_draw(clips[1:]).name == "talos"
    assert robot_to_draw(clips).name == "talos"
    assert robot_to_draw([replace(clips[0], robot="g1")]).name == "g1"
    assert robot_to_draw([replace(clips[0], robot="of its own")]).name == "talos"
    with pytest.raises(InputError, match="of different robots, talos and g1"):
        robot_to_draw([*clips, replace(clips[0], robot="g1")])
