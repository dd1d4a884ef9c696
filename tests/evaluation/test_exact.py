from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.sampling import SamplingSettings
from jaxleas.evaluation.exact import (
    Bookkeeping,
    ask,
    contender,
    judge_exact,
    result_key,
    summarise_plans,
)
from jaxleas.evaluation.judge import roll_out_cell
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.guide import rb_lin
from jaxleas.labels import Judge, Verdict
from tests.evaluation.conftest import Fly, StandStill, flat_scene


def verdict(number: int, success: bool, decided: bool = True) -> Verdict:
    return Verdict(
        path=number,
        decided=decided,
        success=success,
        last_index=0,
        length=2,
        reached=1.0,
        steps=10,
        mean_step=0.1 * (number + 1) if success else 9.0,
        repositions=0,
        least_robustness=1.0,
        mean_robustness=10.0 * (number + 1) if success else 99.0,
        undecided=None,
        combinations=None,
        reason="",
        seconds=0.0,
    )


class Oracle:
    """An exact planner that says what it was told to, and remembers what it was asked."""

    def __init__(self, answers):
        self.answers, self.asked = answers, []

    def judge(self, scenes, paths, scene_index, on_done=lambda count: None):
        self.asked.append((scenes, paths, list(scene_index)))
        on_done(len(paths))
        return [verdict(number, *self.answers(number)) for number in range(len(paths))]


@pytest.fixture
def two_scenes(flat_suite):
    """A suite of one cell over two scenes of which the second is raised by a metre."""
    low, high = flat_scene(), flat_scene()
    up = np.array([0.0, 0.0, 1.0])
    raised = {name: vertices + up for name, vertices in high.scene.surfaces.items()}
    high = replace(high, scene=replace(high.scene, surfaces=raised))
    cell = replace(flat_suite.cells[0], scenarios=(low, high))
    return replace(flat_suite, cells=(cell,))


def test_the_share_is_of_all_starts_and_the_means_are_of_what_succeeded(env, two_scenes):
    (cell,) = two_scenes.cells
    grounds = make_grounds(two_scenes.cells)
    walked = roll_out_cell(env, grounds, Fly(), draw_starts(env, grounds, cell, 0), 5)
    reached = np.array([True] * 6 + [False] * 2)
    walked = replace(walked, reached=reached)
    oracle = Oracle(lambda number: (number in (0, 2, 3), number != 5))
    judged = ask(cell, walked, oracle, 0.2)
    assert judged.planned.tolist() == [True, False, True, True, False, False, False, False]
    assert judged.verdicts[6:] == (None, None)
    ((_, paths, _),) = oracle.asked
    assert len(paths) == 6  # who has not arrived has no guide path to plan along
    result = summarise_plans(cell, "fly", "sampling", judged, 0.2)
    assert result.planned == result.success == 3 / 8
    assert (result.low, result.high) == pytest.approx(wilson_interval(3, 8), abs=1e-6)
    assert result.undecided == 1 / 8
    assert result.robustness == pytest.approx((10.0 + 30.0 + 40.0) / 3)
    assert result.mean_step == pytest.approx((0.1 + 0.3 + 0.4) / 3, abs=1e-6)


def test_every_guide_path_is_judged_over_its_own_scene(env, two_scenes):
    oracle = Oracle(lambda number: (True,))
    judge_exact(env, {"fly": contender(env, Fly())}, two_scenes, {"sampling": oracle})
    ((scenes, paths, index),) = oracle.asked
    for path, each in zip(paths, index, strict=True):
        (floor,) = scenes[each].surfaces.values()
        assert path.position[0, 2] == pytest.approx(floor[0, 2] + env.robot.walking_height)
    assert sorted(set(index)) == [0, 1]


def test_methods_and_planners_share_starts_and_guides(env, flat_suite):
    yes, no = Oracle(lambda number: (True,)), Oracle(lambda number: (False,))
    walkers = {"fly": contender(env, Fly()), "still": contender(env, StandStill())}
    results = judge_exact(env, walkers, flat_suite, {"sampling": yes, "mip": no})
    assert [(each.yaw, each.method, each.planner, each.planned) for each in results] == [
        (yaw, method, planner, 1.0 if (method, planner) == ("fly", "sampling") else 0.0)
        for yaw in (0.0, 180.0)
        for method in ("fly", "still")
        for planner in ("sampling", "mip")
    ]
    assert len(yes.asked) == 2  # nobody asks about who stood still
    for (_, mine, _), (_, theirs, _) in zip(yes.asked, no.asked, strict=True):
        assert all(a.position is b.position or (a.position == b.position).all()
                   for a, b in zip(mine, theirs, strict=True))  # fmt: skip


def test_what_is_known_is_neither_walked_nor_asked_again(env, flat_suite):
    walks, oracle = [], Oracle(lambda number: (True,))

    def fly(grounds, starts, steps):
        walks.append(steps)
        return roll_out_cell(env, grounds, Fly(), starts, steps)

    first = judge_exact(env, {"fly": fly}, flat_suite, {"sampling": oracle})
    known = {result_key(each): each for each in first}
    again = judge_exact(
        env, {"fly": fly}, flat_suite, {"sampling": oracle}, bookkeeping=Bookkeeping(known)
    )
    assert again == first
    assert len(walks) == len(oracle.asked) == 2


def test_without_planners_the_walks_are_counted(env, flat_suite):
    results = judge_exact(env, {"fly": contender(env, Fly())}, flat_suite, {})
    assert [(each.planner, each.planned, each.reached) for each in results] == [
        (None, None, 1.0)
    ] * 2


def test_the_sampling_planner_follows_a_walk_but_no_leap(env, flat_suite):
    suite = replace(flat_suite, cells=flat_suite.cells[:1])
    walkers = {
        "fly": contender(env, Fly()),
        "rb_lin": contender(env, rb_lin(env.config.limits, env.config.desired_speed)),
    }
    with Judge("sampling", SamplingSettings(samples=4000), robot="talos") as planner:
        leap, steps = judge_exact(env, walkers, suite, {"sampling": planner})
    assert leap.reached == steps.reached == 1.0
    assert (leap.planned, steps.planned) == (0.0, 1.0)
    assert leap.mean_step is None
    assert steps.robustness is not None
    assert steps.mean_step is not None
    assert steps.robustness > 5.0
    assert 0.05 < steps.mean_step < 0.3
