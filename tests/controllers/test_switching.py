"""Controllers that take turns: a switch is seamless, and touches no other robot."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from jaxleas.controllers import Switching, Walk, find_controller
from jaxleas.controllers.switching import merged
from jaxleas.physics import load_body, make_physics, standing
from jaxleas.types import InputError

BODY = load_body("anymal_b")


def trots():
    return [find_controller(name, BODY) for name in ("trot", "trot_high")]


def walked(controller, commands, ticks, switch=None):
    walk = Walk(make_physics(BODY, len(commands)), controller)
    walking = walk.begin(standing(BODY, np.zeros((len(commands), 3))))
    for tick in range(ticks):
        if switch is not None and tick == switch[0]:
            memory = controller.switched(walking.memory, walking.state, np.array(switch[1]))
            walking = replace(walking, memory=memory)
        walking = walk.tick(walking, commands).walking
    return walking


def test_robots_that_keep_the_first_controller_walk_as_with_it_alone():
    commands = np.array([[0.4, 0.0, 0.0], [0.0, 0.2, 0.0]])
    low, both = trots()[0], Switching(trots())
    alone = walked(low, commands, 60)
    one_switches = walked(both, commands, 60, switch=(20, [0, 1]))
    np.testing.assert_allclose(
        one_switches.state.coordinates[0], alone.state.coordinates[0], rtol=0, atol=1e-9
    )
    assert np.abs(one_switches.state.coordinates[1] - alone.state.coordinates[1]).max() > 1e-3
    np.testing.assert_array_equal(one_switches.memory.chosen, [0, 1])


def test_a_controller_that_takes_over_begins_as_from_a_stand():
    """At the same instant its first decision is that of a controller which starts there."""
    low, high = trots()
    both = Switching([low, high])
    command = np.array([[0.3, 0.0, 0.0]])
    walking = walked(both, command, 30)
    memory = both.switched(walking.memory, walking.state, np.array([1]))
    _, joints = both.act(memory, walking.state, walking.sensed, command)
    _, fresh = high.act(high.start(walking.state), walking.state, walking.sensed, command)
    np.testing.assert_array_equal(joints.torques, fresh.torques)
    again = both.switched(memory, walking.state, np.array([1]))
    np.testing.assert_array_equal(again.memories[1].phase, memory.memories[1].phase)


def test_memories_of_any_shape_are_merged_by_robot():
    old, new = (np.zeros(2), (np.zeros((2, 3)),)), (np.ones(2), (np.ones((2, 3)),))
    flat, (deep,) = merged(np.array([False, True]), new, old)
    np.testing.assert_array_equal(flat, [0.0, 1.0])
    np.testing.assert_array_equal(deep, [[0.0] * 3, [1.0] * 3])


@dataclass
class Renamed:
    """A controller that differs in one thing."""

    identity: object
    period: float = 0.004


def test_controllers_that_differ_in_more_than_swings_are_refused():
    low = trots()[0]
    slow = Renamed(replace(low.identity, name="slow", max_speeds=(0.5, 0.5, 1.0)))
    with pytest.raises(InputError, match=r"trot and slow cannot take turns: max_speeds is \(1.0"):
        Switching([low, slow])
    with pytest.raises(InputError, match=r"they decide every 0.004 and 0.02 s"):
        Switching([low, Renamed(low.identity, period=0.02)])
