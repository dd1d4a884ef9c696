"""Steering methods are named in one place, and every old name still finds its method."""

import numpy as np
import pytest

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.guide import RbKino, RbLin
from jaxleas.guide.registry import (
    BASELINES,
    KINO,
    LEAS,
    LIN,
    METHODS,
    Edges,
    compared,
    find_method,
    is_policy,
    method_of,
)
from jaxleas.types import InputError

OWN = """
from jaxleas.guide import Edges, Method, rb_lin


def make(env, policy):
    return rb_lin(env.config.limits, 0.5 * env.config.desired_speed)


SLOW = Method("lin", "rb_lin", "half speed", make, edges=Edges(2.0, 0.1), colour="#000000")


class Slow:
    def __init__(self, limits, desired_speed):
        self.speed = desired_speed
"""


@pytest.fixture(scope="module")
def env():
    return SteeringEnv(SteeringConfig())


@pytest.fixture
def own(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "own_steering.py").write_text(OWN)


@pytest.mark.parametrize("method", METHODS, ids=lambda each: each.name)
def test_a_method_is_found_by_both_of_its_names(method):
    assert find_method(method.name) is method
    assert find_method(method.key) is method
    assert method_of(method.key) is method


def test_names_in_files_and_options_stay():
    assert [(each.name, each.key) for each in METHODS] == [
        ("leas", "leas_p1"),
        ("lin", "rb_lin"),
        ("kino", "rb_kino"),
    ]
    assert list(BASELINES) == ["rb_lin", "rb_kino"]
    assert compared() == ["rb_lin", "rb_kino", "rb_kino_rrt", "leas_p1"]


def test_no_two_methods_share_a_name_or_a_colour():
    every = [*METHODS, KINO.with_roadmap()]
    for name in ("name", "key", "title", "colour"):
        assert len({getattr(each, name) for each in every}) == len(every)


def test_baselines_are_made_without_a_policy_and_leas_is_not(env):
    assert isinstance(LIN.make(env, None), RbLin)
    assert isinstance(KINO.make(env, None), RbKino)
    with pytest.raises(InputError, match="leas needs a policy"):
        LEAS.make(env, None)


def test_a_roadmap_changes_key_title_and_colour():
    kino = method_of("rb_kino_rrt")
    assert kino is not None
    assert (kino.title, kino.colour) == ("RB-Kino + RRT", "#b8860b")
    assert kino.edges == KINO.edges


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("leas_p1", True),
        ("leas_p1_rrt", True),
        ("leas_p2_mip", True),
        ("mine", True),
        ("rb_lin", False),
        ("rb_kino_rrt", False),
        ("my:Method", False),
    ],
)
def test_results_are_a_policys_or_a_baselines(key, expected):
    assert is_policy(key) is expected


def test_own_method_says_how_it_is_searched_with_and_drawn(env, own):
    found = find_method("own_steering:SLOW")
    assert (found.name, found.key, found.title) == (*["own_steering:SLOW"] * 2, "half speed")
    assert found.edges == Edges(2.0, 0.1)
    np.testing.assert_allclose(
        found.make(env, None).desired_speed,  # type: ignore[attr-defined]
        0.5 * env.config.desired_speed,
    )


def test_own_class_is_made_of_limits_and_speed(env, own):
    found = find_method("own_steering:Slow")
    assert found.make(env, None).speed == env.config.desired_speed  # type: ignore[attr-defined]
    assert found.edges == LIN.edges
    assert not found.needs_policy


def test_results_of_own_methods_never_run_code(own):
    assert method_of("own_steering:SLOW") is None


def test_an_unknown_method_gets_the_nearest_and_the_list():
    with pytest.raises(InputError, match=r"perhaps you meant kino; there are leas, lin, kino"):
        find_method("kinoo")
