"""The pair of feet that a controller swings first, measured: a planner needs it at the start."""

import numpy as np

from jaxleas.controllers import TICK, Controller, Walk
from jaxleas.footsteps import ContactWatch
from jaxleas.physics import Body, Physics, make_physics, standing
from jaxleas.types import InputError


def first_pair(body: Body, controller: Controller) -> int:
    """Return the pair of feet that a controller swings first from standing.

    It is measured: a robot walks on level ground until a footstep has ended.

    Raises:
        InputError: the controller makes no footstep.
    """
    physics: Physics = make_physics(body, 1)
    walk = Walk(physics, controller)
    walking = walk.begin(standing(body, np.zeros((1, 3))))
    watch = ContactWatch(controller.identity, 1)
    command = np.array([[START * controller.identity.max_speeds[0], 0.0, 0.0]])
    for _ in range(round(LONGEST_START / TICK)):
        pair = int(watch.update(walking.sensed)[0])
        if pair >= 0:
            return pair
        walking = walk.tick(walking, command).walking
    raise InputError(
        f"controller {controller.identity.name}: no pair of feet swung within"
        f" {LONGEST_START:g} s of walking ahead on level ground"
    )


START, LONGEST_START = 0.3, 3.0
"""Share of the largest speed, and time, in which a controller must make a first footstep."""
