"""Robots that follow plans together: one alone, in a batch, stopped by a person, and fallen."""

import numpy as np
import pytest

from jaxleas.controllers import PhaseTracker, Walk, find_controller, joined, standing_with
from jaxleas.crossing import track
from jaxleas.gaits import track_of
from jaxleas.physics import Variation, load_body, make_physics
from jaxleas.types import InputError
from tests.controllers.tracks import one_step

BODY = load_body("anymal_b")


def level(places):
    return np.zeros(len(places))


def walk_of(count, **physics):
    plan = one_step(times=0.5)
    tracks = joined([track_of(plan, level, (BODY.foot_radius, 0.05))] * count)
    com = tracks.at(np.zeros(count)).com
    start, _ = standing_with(BODY, com, tracks.yaws[:, 0], tracks.feet[:, 0])
    walk = Walk(make_physics(BODY, count, **physics), PhaseTracker(BODY, tracks))
    return walk, start


def test_a_person_may_stop_it_and_what_happened_is_kept():
    walk, start = walk_of(1)
    ticks = []

    def stop(ticked, command):
        ticks.append(command)
        if len(ticks) == 60:
            raise KeyboardInterrupt

    (made,) = track(walk, start, 9.0, stop)
    assert made.outcome == "interrupted"
    assert len(made.log.support) == 12
    assert made.fts == 0.0
    assert made.fter < 0.01


@pytest.mark.slow
def test_a_fall_ends_one_robot_and_no_other():
    ice = Variation(np.array([0.8, 0.001]), np.ones(2))
    walk, start = walk_of(2, variation=ice)
    start.speeds[1, 4] = 6.0  # it pitches
    firm, slips = track(walk, start, 4.0)
    assert (firm.outcome, firm.fts) == ("followed", 1.0)
    assert slips.outcome == "fell"
    assert slips.cause in ("tilted", "low")
    assert len(slips.log.support) < len(firm.log.support)


def test_other_controllers_are_refused():
    walk, start = walk_of(1)
    with pytest.raises(InputError, match="needs a PhaseTracker"):
        track(Walk(walk.physics, find_controller("trot", BODY)), start, 1.0)
