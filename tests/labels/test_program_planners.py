"""MIP and SL1M as judges, on walks whose answer is known."""

from dataclasses import replace
from typing import get_args

import pytest

from jaxleas.contacts import PlannerError, plan_mip, problem_from_guide
from jaxleas.contacts.from_guide import NoGroundError, kept_configurations
from jaxleas.contacts.programs import mip
from jaxleas.contacts.sampling.plan import Ending
from jaxleas.contacts.sampling_planner import CAUSE_OF_ENDING
from jaxleas.labels import AskedGuides, MipSettings, Sl1mSettings, ask, judge
from jaxleas.robots import load_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import CAUSES
from tests.contacts.sampling.worlds import flat, floor, hole, stairs, straight

BOTH = pytest.mark.parametrize("planner", ["mip", "sl1m"])


@BOTH
def test_a_walk_on_flat_ground_succeeds(planner):
    path = straight(2.0)
    (verdict,) = judge(planner, flat(), [path], robot="talos")
    assert verdict.decided
    assert verdict.success
    assert (verdict.reason, verdict.cause) == ("", None)
    assert verdict.last_index == len(path) - 1
    assert verdict.reached == 1.0
    assert verdict.steps == len(kept_configurations(len(path), 14)) == 8
    assert verdict.mean_step == pytest.approx(2.0 / 8)
    assert verdict.seconds > 0.0
    if planner == "sl1m":
        assert (verdict.undecided, verdict.combinations) == (0, 1)
    else:
        assert (verdict.undecided, verdict.combinations) == (None, None)


@BOTH
def test_the_last_index_is_the_last_prefix_that_has_a_plan(planner):
    """A hole of 1.5 m: prefix after prefix is asked one by one, by the mixed-integer planner."""
    path, scene = straight(4.0), hole()
    (verdict,) = judge(planner, scene, [path], robot="talos")
    assert not verdict.success
    assert verdict.cause == "no_ground"
    kept = kept_configurations(len(path), 14)
    made = -1
    for steps in range(1, len(kept)):
        beginning = path[: kept[steps - 1] + 1]
        try:
            problem = problem_from_guide(beginning, scene, "talos")
        except NoGroundError:
            break
        if not plan_mip(problem, diagnose=False).feasible:
            break
        made = steps - 1
    assert verdict.last_index == kept[made]
    assert verdict.steps == made + 1
    assert 1.0 < path.position[verdict.last_index, 0] < 2.3


def test_steps_too_long_for_the_legs_fail_and_shorter_ones_do_not():
    path = straight(3.5, climbing=True)
    long, short = (
        judge("mip", stairs(), [path], MipSettings(keep_every=every), robot="talos")[0]
        for every in (40, 12)
    )
    assert not long.success
    assert long.cause == "infeasible"
    assert short.success


def test_where_the_scene_ends_the_verdict_ends():
    """Not bad input: a policy may walk anywhere."""
    short = Scene({"floor": floor(-2.0, 1.2, -2.0, 2.0)})
    (verdict,) = judge("mip", short, [straight(4.0)], robot="talos")
    assert verdict.decided
    assert not verdict.success
    assert verdict.cause == "no_ground"
    assert 0 < verdict.last_index < 60
    (nowhere,) = judge("mip", short, [straight(1.0, start=5.0)], robot="talos")
    assert (nowhere.last_index, nowhere.steps, nowhere.mean_step) == (-1, 0, None)
    assert nowhere.cause == "no_start"


@BOTH
def test_a_path_of_one_configuration_only_has_to_stand(planner):
    here = straight(1.0)[:1]
    (verdict,) = judge(planner, flat(), [here], robot="talos")
    assert (verdict.success, verdict.last_index, verdict.steps) == (True, 0, 0)
    beside = replace(here, position=here.position + 50.0)
    (verdict,) = judge(planner, flat(), [beside], robot="talos")
    assert (verdict.success, verdict.last_index) == (False, -1)


def test_what_is_far_away_does_not_matter():
    far = {f"far_{n}": floor(20.0 + n, 20.9 + n, 20.0, 21.0) for n in range(30)}
    path = straight(1.5, climbing=True)
    (here,) = judge("sl1m", stairs(), [path], robot="talos")
    (there,) = judge("sl1m", Scene({**far, **stairs().surfaces}), [path], robot="talos")
    assert replace(there, seconds=here.seconds) == here


@pytest.mark.parametrize("planner", ["mip", "sl1m"])
def test_no_time_is_no_verdict(planner):
    kind = MipSettings if planner == "mip" else Sl1mSettings
    (verdict,) = judge(
        planner, stairs(), [straight(3.0, climbing=True)], kind(time_limit=1e-6), robot="talos"
    )
    assert not verdict.decided
    assert not verdict.success
    assert verdict.cause == "time_limit"


def test_a_planner_that_breaks_gives_no_verdict(monkeypatch):
    def broken(*args, **kwargs):
        raise PlannerError("no answer")

    monkeypatch.setattr(mip, "plan_mip", broken)
    (verdict,) = judge("mip", flat(), [straight(1.0)], robot="talos")
    assert not verdict.decided
    assert verdict.cause == "planner_failed"
    assert "no answer" in verdict.reason


def test_many_scenes_answer_in_the_order_of_the_paths():
    paths = [straight(1.0), straight(3.0), straight(1.2), straight(3.2)]
    asked = AskedGuides("talos", [flat(), hole()], paths, [0, 1, 1, 0], first=10)
    verdicts = ask("sampling", asked)
    assert [verdict.path for verdict in verdicts] == [10, 11, 12, 13]
    for verdict, path, scene in zip(verdicts, paths, (flat(), hole(), hole(), flat()), strict=True):
        (alone,) = judge("sampling", scene, [path], robot="talos")
        assert (verdict.success, verdict.last_index) == (alone.success, alone.last_index)
        assert verdict.length == len(path)
        assert verdict.cause == (None if verdict.success else "no_contact")
    (nowhere,) = judge("sampling", hole(), [straight(1.0, start=50.0)], robot="talos")
    assert nowhere.cause == "no_start"


def g1_walk(length: float):
    """A straight walk at the walking height of a smaller biped."""
    path = straight(length)
    root = [0.0, 0.0, load_robot("g1").walking_height]
    return replace(path, position=path.position * [1.0, 1.0, 0.0] + root)


@BOTH
def test_another_biped_is_judged_by_its_own_polytopes(planner):
    kind = MipSettings if planner == "mip" else Sl1mSettings
    near, far = (
        judge(planner, flat(), [g1_walk(2.0)], kind(keep_every=every), robot="g1")[0]
        for every in (10, 19)
    )
    assert near.success
    assert not far.success  # Talos's legs would do
    assert judge(planner, flat(), [straight(2.0)], kind(keep_every=19), robot="talos")[0].success
    (lost,) = judge(planner, flat(), [straight(2.0)], robot="g1")  # at Talos's height
    assert not lost.success


@pytest.mark.slow
def test_another_biped_is_judged_by_sampling_its_own_legs():
    near, tall = judge("sampling", flat(), [g1_walk(1.0), straight(1.0)], robot="g1")
    assert near.success
    assert not tall.success


def test_every_ending_of_a_sampling_plan_has_its_cause():
    endings = set(get_args(Ending)) - {"reached"}
    assert set(CAUSE_OF_ENDING) == endings
    assert set(CAUSE_OF_ENDING.values()) <= set(CAUSES)
