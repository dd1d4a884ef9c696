"""The trot: it goes where it is told, on one robot as in a batch, and stands when told to."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest

from jaxleas.controllers import (
    CONTROLLERS,
    TICK,
    UPRIGHT,
    Walk,
    Walking,
    falls,
    find_controller,
)
from jaxleas.physics import Sensed, Variation, load_body, make_physics, standing
from jaxleas.terrain import Scene

BODY = load_body("anymal_b")
COMMANDS = np.array(
    [
        [0.6, 0, 0],
        [0, 0.3, 0],
        [0, -0.3, 0],
        [0, 0, -0.6],
        [0, 0, 0.6],
        [0.3, 0.2, 0],
        [0.3, -0.2, 0],
    ]
)


@dataclass(frozen=True)
class Trip:
    """What was measured on the way, and the robots at its end."""

    sensed: list[Sensed]
    end: Walking

    def after(self, seconds: float) -> list[Sensed]:
        return self.sensed[round(seconds / TICK) :]


def walked(name: str, commands: np.ndarray, seconds: float) -> Trip:
    count, sensed = len(commands), []
    walk = Walk(make_physics(BODY, count), find_controller(name, BODY))
    walking = walk.begin(standing(BODY, np.zeros((count, 3))))
    for _ in range(round(seconds / TICK)):
        walking = walk.tick(walking, commands).walking
        sensed.append(walking.sensed)
    assert (falls(BODY, walking.state, walking.sensed) == UPRIGHT).all()
    return Trip(sensed, walking)


@pytest.fixture(scope="module", params=CONTROLLERS)
def trip(request: pytest.FixtureRequest) -> tuple[str, Trip]:
    return request.param, walked(request.param, COMMANDS, 2.6)


def test_every_trot_follows_every_movement(trip: tuple[str, Trip]) -> None:
    begun, after = trip[1].after(0.6)[0], trip[1].end.sensed
    moved = (after.com - begun.com) / 2.0
    turned = (after.yaw - begun.yaw) / 2.0
    # Sideways it goes about two thirds as fast as it is told.
    speeds = np.array([moved[0, 0], moved[1, 1], moved[2, 1], turned[3], turned[4]])
    share = speeds / COMMANDS[:5][COMMANDS[:5] != 0.0]
    assert (share > 0.6).all()
    assert (share < 1.1).all()
    assert np.abs(turned[:3]).max() < 0.05
    assert np.abs(moved[0, 1]) < 0.05
    # Left is right in a mirror; the URDF's trunk is not quite its own mirror image.
    np.testing.assert_allclose(moved[5], moved[6] * [1.0, -1.0, 1.0], atol=0.03)


def test_feet_swing_in_diagonal_pairs_to_the_set_height(trip: tuple[str, Trip]) -> None:
    controller = find_controller(trip[0], BODY)
    way = trip[1].after(0.6)
    heights = np.stack([each.feet[5, :, 2] for each in way]) - BODY.foot_radius
    air = np.stack([each.forces[5] == 0.0 for each in way])
    np.testing.assert_allclose(heights.max(axis=0), controller.identity.swing_height, atol=0.012)
    for one, other in controller.identity.pairs:
        assert (air[:, one] == air[:, other]).mean() > 0.85
    first, second = (air[:, list(pair)].all(axis=1) for pair in controller.identity.pairs)
    assert not (first & second).any()
    assert first.mean() > 0.3


def test_identities_differ_where_the_walks_differ() -> None:
    low, high, quick = (find_controller(name, BODY).identity for name in CONTROLLERS)
    assert low.pair_names == ("LF/RH", "RF/LH")
    assert (low.swing_height, high.swing_height) == (0.065, 0.10)
    assert (low.settings["cycle"], quick.settings["cycle"]) == (0.60, 0.50)
    assert (low.settings["touchdown"], quick.settings["touchdown"]) == ("speed_error", "capture")


def test_robots_of_a_batch_do_not_know_of_each_other(trip: tuple[str, Trip]) -> None:
    alone = walked(trip[0], COMMANDS[[1]], 0.4)
    np.testing.assert_array_equal(alone.sensed[-1].feet[0], trip[1].sensed[99].feet[1])


def test_a_robot_told_to_stop_stands_and_steps_no_more() -> None:
    walk = Walk(make_physics(BODY, 1), find_controller("trot", BODY))
    walking = walk.begin(standing(BODY, np.zeros((1, 3))))
    for tick in range(450):
        command = np.array([[0.6 if tick < 200 else 0.0, 0.0, 0.0]])
        walking = walk.tick(walking, command).walking
    before = walking.sensed
    for _ in range(160):
        walking = walk.tick(walking, np.zeros((1, 3))).walking
        assert (walking.sensed.forces > 10.0).all()
    np.testing.assert_allclose(walking.sensed.feet, before.feet, atol=0.005)


@pytest.mark.parametrize("name", ["trot", "trot_high"])
def test_trots_climb_the_first_stairs_of_the_thesis_without_seeing_them(name: str) -> None:
    """Risers of 4.2 cm on treads of a third of a metre (section 5.2): three steps up."""
    edges = np.array([-2.0, 1.0, 4.0 / 3.0, 5.0 / 3.0, 6.0])
    steps = {
        f"step {index}": np.array(
            [[x, y, 0.042 * index] for x, y in ((a, -1.0), (b, -1.0), (b, 1.0), (a, 1.0))]
        )
        for index, (a, b) in enumerate(itertools.pairwise(edges))
    }
    walk = Walk(make_physics(BODY, 3, Scene(steps)), find_controller(name, BODY))
    walking = walk.begin(standing(BODY, np.array([[0.5, 0.0, 0.0], [0.55, 0, 0], [0.6, 0, 0]])))
    for _ in range(1500):
        walking = walk.tick(walking, np.array([[0.5, 0.0, 0.0]] * 3)).walking
    assert (falls(BODY, walking.state, walking.sensed) == UPRIGHT).all()
    assert (walking.state.position[:, 0] > 2.4).all()
    assert (walking.sensed.feet[..., 2] > 3 * 0.042).all()


def test_noise_is_drawn_from_the_seed() -> None:
    walk = Walk(make_physics(BODY, 1), find_controller("trot", BODY), noise=2.0)

    def places(seed: int) -> np.ndarray:
        rng, walking = np.random.default_rng(seed), walk.begin(standing(BODY, np.zeros((1, 3))))
        for _ in range(20):
            walking = walk.tick(walking, np.zeros((1, 3)), rng).walking
        return walking.state.coordinates

    np.testing.assert_array_equal(places(1), places(1))
    assert (places(1) != places(2)).any()


def test_a_robot_without_friction_falls_and_it_is_seen() -> None:
    variation = Variation(np.array([0.01, 0.8]), np.ones(2))
    walk = Walk(make_physics(BODY, 2, variation=variation), find_controller("trot", BODY))
    walking = walk.begin(standing(BODY, np.zeros((2, 3))))
    fell = np.zeros(2, dtype=bool)
    for _ in range(750):
        walking = walk.tick(walking, np.array([[0.8, 0.3, 0.5]] * 2)).walking
        fell |= falls(BODY, walking.state, walking.sensed) != UPRIGHT
        if fell[0]:
            break
    assert fell.tolist() == [True, False]
