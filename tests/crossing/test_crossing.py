"""What a commander is given at each contact: the command until then, and the one before."""

import numpy as np
import pytest

from jaxleas.crossing import cross, standing_on
from jaxleas.crossing.commanders import Decision
from jaxleas.terrain import Scene
from tests.terrain.test_scene_edges import rectangle


class Alternating:
    """Commands one speed after the other, and keeps what it was given."""

    def __init__(self):
        self.told = []
        self.given = [np.zeros(3), np.zeros(3)]

    def decide(self, state):
        self.told.append((state.command, state.earlier))
        speed = (0.2, 0.3, 0.4)[len(self.told) % 3]
        self.given.append(np.array([speed, 0.0, 0.0]))
        return Decision("go", self.given[-1], None, 0.0, 0)


def test_a_commander_is_told_the_last_two_commands():
    pytest.importorskip("mujoco")
    from jaxleas.controllers import Walk, find_controller
    from jaxleas.physics import load_body, make_physics

    body, scene = load_body("anymal_b"), Scene({"ground": rectangle(-2.0, 2.0, -2.0, 2.0, 0.0)})
    walk = Walk(make_physics(body, 1, scene), find_controller("trot", body))
    commander = Alternating()
    cross(walk, standing_on(scene, body, [(0.0, 0.0, 0.0)]), [commander], 2.0)
    assert len(commander.told) > 4
    for number, (command, earlier) in enumerate(commander.told):
        np.testing.assert_array_equal(earlier, commander.given[number])
        np.testing.assert_array_equal(command, commander.given[number + 1])
