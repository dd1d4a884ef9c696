import numpy as np
import pytest

from jaxleas.evaluation.contender import contender
from jaxleas.evaluation.judge import path_lengths
from jaxleas.evaluation.roadmap_contender import roadmap_contender, stack
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.evaluation.suites import make_suite
from jaxleas.guide import rb_kino
from jaxleas.guide.registry import KINO
from jaxleas.types import GuidePath


def line(first: float, last: float, count: int) -> GuidePath:
    position = np.zeros((count, 3))
    position[:, 0] = np.linspace(first, last, count)
    return GuidePath(
        np.arange(count) * 0.2,
        position,
        np.zeros(count),
        np.zeros((count, 3)),
        np.ones(count, dtype=bool),
    )


def test_paths_of_any_length_make_one_walk():
    short, long = line(0.0, 1.0, 3), line(0.0, 3.0, 5)
    long.valid[4] = False
    roll_outs = stack([short, long], np.array([True, True]), None)  # type: ignore[arg-type]
    assert roll_outs.end.tolist() == [2, 4]
    assert roll_outs.position[0, :, 0] == pytest.approx([0.0, 0.5, 1.0, 1.0, 1.0])
    assert roll_outs.reached.tolist() == [True, False]
    assert roll_outs.invalid.tolist() == [False, True]
    assert len(roll_outs.guide_path(0, 0.2)) == 3


@pytest.mark.slow
def test_a_roadmap_leads_around_the_hole_where_the_straight_way_does_not(env):
    pytest.importorskip("ompl")
    suite = make_suite("hole", 4)
    (cell,) = suite.cells
    grounds = make_grounds(suite.cells)
    starts = draw_starts(env, grounds, cell, suite.stream())
    method = rb_kino(env.config.limits, env.config.desired_speed)
    alone = contender(env, method)(grounds, starts, suite.steps)
    led = roadmap_contender(env, method, KINO.edges)(grounds, starts, 3000)
    assert led.reached.sum() > alone.reached.sum()
    length, straight = path_lengths(led)
    around = led.reached & ~alone.reached
    assert (length[around] > straight[around] + 0.01).all()
