"""Places that the robot can stand on and neither leave nor reach."""

import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.guide import Places
from jaxleas.guide.cut_off import HALF, look_around, require_not_cut_off
from jaxleas.guide.navigation_command import navigate
from jaxleas.terrain import HeightMap, write_height_map
from jaxleas.types import InputError

ENV = SteeringEnv(SteeringConfig())
HERE, THERE = (1.5, 2.0), (4.0, 2.0)


def ground(half: float = 0.2, inside: float = 0.0, outside: float = 0.0) -> HeightMap:
    """Return level ground of 6 x 4 m with a square of another height around `HERE`."""
    cell = 0.04
    x, y = np.meshgrid(cell * np.arange(150), cell * np.arange(100))
    within = np.maximum(abs(x - HERE[0]), abs(y - HERE[1])) <= half
    heights = np.where(within, inside, outside).astype(np.float32)
    return HeightMap(heights, cell, (0.0, 0.0))


def refused(terrain: HeightMap, start=HERE, goal=THERE) -> str:
    with pytest.raises(InputError) as stopped:
        require_not_cut_off(Places(ENV, terrain), start, goal)
    return str(stopped.value)


def test_even_ground_is_plain() -> None:
    assert look_around(Places(ENV, ground()), HERE) is None
    assert look_around(Places(ENV, ground(0.2, 0.1)), HERE) is None


def test_spikes_pits_and_islands_are_named() -> None:
    said = refused(ground(0.2, 0.7))
    assert said.startswith("--from 1.5,2: the robot stands on a spike 0.70 m above the ground")
    assert "and no way leads off; the nearest place apart from it is" in said
    beside = (HERE[0] + 0.6, HERE[1])
    assert "--to 1.5,2: the goal lies on a spike" in refused(ground(0.2, 0.7), beside, HERE)
    assert "in a pit 0.60 m below the ground around it" in refused(ground(0.3, -0.6))
    said = refused(ground(0.3, 0.0, np.nan))
    assert "on an island with no ground around it, and no way leads off" in said
    assert "nearest" not in said


def test_what_can_be_left_is_not_refused() -> None:
    require_not_cut_off(Places(ENV, ground(0.2, 0.18)), HERE, THERE)  # a step of stairs
    require_not_cut_off(Places(ENV, ground(1.2, 0.7)), HERE, (2.2, 2.0))  # a platform, too wide
    require_not_cut_off(Places(ENV, ground(0.04, 0.5)), THERE, (1.5, 1.6))  # beside a thin post
    near = (HERE[0] + 0.25, HERE[1])  # the goal lies within reach on the spike
    require_not_cut_off(Places(ENV, ground(0.3, 0.7)), HERE, near)
    ramp = ground(0.2, 0.7)
    x = ramp.origin[0] + ramp.resolution * np.arange(ramp.heights.shape[1])
    slope = np.clip(0.7 - 0.5 * (x - 1.7), 0.0, 0.7).astype(np.float32)
    heights = ramp.heights.copy()
    heights[40:60, x > 1.6] = slope[x > 1.6]  # a ramp leads down, 0.8 m wide
    require_not_cut_off(Places(ENV, HeightMap(heights, 0.04, (0.0, 0.0))), HERE, THERE)


def test_a_heading_that_is_not_searched_is_no_reason_to_refuse() -> None:
    around = look_around(Places(ENV, ground(0.2, 0.7)), HERE)
    assert around is not None
    assert around.reached[HALF, HALF]
    assert not around.leads_out


@pytest.mark.parametrize("where", ["here", "cases"])
def test_navigate_says_so(tmp_path, where, request) -> None:
    file, start = tmp_path / "spike.npz", "1.5,2"
    write_height_map(file, ground(0.2, 0.7))
    if where == "cases":
        file = request.getfixturevalue("shared") / "cases" / "spike_under_start.npz"
        if not file.is_file():
            pytest.skip("needs ../shared/cases")
        start = "1,2"
    out = tmp_path / "guide.npz"
    with pytest.raises(InputError, match=r"stands on a spike 0\.70 m above the ground around it"):
        navigate(from_=start, to="5,2", terrain=file, steering="kino", planner="none", out=out)
    assert not out.exists()
