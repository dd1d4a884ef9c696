"""Footsteps found while robots walk are those found in their log."""

import numpy as np
import pytest

from jaxleas.controllers import Walk, find_controller
from jaxleas.footsteps import NONE, ContactWatch, extract_footsteps
from jaxleas.footsteps.samples import SampleLog
from jaxleas.physics import load_body, make_physics, standing


@pytest.mark.parametrize("seed", [0, 1])
def test_the_watch_agrees_with_the_log(seed):
    body, ticks, rng = load_body("anymal_b"), 500, np.random.default_rng(seed)
    walk = Walk(make_physics(body, 2), find_controller("trot", body), noise=2.0)
    walking = walk.begin(standing(body, np.zeros((2, 3))))
    watch = ContactWatch(walk.controller.identity, 2)
    log, found = SampleLog(ticks, 2, 4), ([], [])
    command = np.array([[0.4, 0.0, 0.0], [0.0, 0.2, 0.0]])
    for _ in range(ticks):
        walking = walk.tick(walking, command, rng).walking
        log.add(walking.sensed, command)
        for robot, pair in enumerate(watch.update(walking.sensed)):
            if pair != NONE:
                found[robot].append((float(walking.sensed.time[robot]), int(pair)))
    for robot in (0, 1):
        steps = extract_footsteps(
            log.of(robot, ticks), 0, walk.controller.identity, "contact"
        ).footsteps
        assert len(steps) > 4
        assert found[robot] == list(zip(steps.time.tolist(), steps.pair.tolist(), strict=True))
