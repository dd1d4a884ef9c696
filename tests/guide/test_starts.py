import numpy as np
import pytest

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.guide.nearest_place import nearest_place
from jaxleas.guide.places import Places
from jaxleas.guide.starts import choose_start, require_start
from jaxleas.terrain import rasterise, transition
from jaxleas.types import InputError
from tests.guide.walkers import flat_map

ENV = SteeringEnv(SteeringConfig())


def test_the_start_is_at_the_back_with_room_around():
    for scene in (transition("bridge", 3).scene, transition("stairs_down", 4).scene):
        terrain = rasterise(scene)
        start = choose_start(ENV, terrain)
        x, y, z = start.position
        assert 0.4 < x < 1.2  # on the first of three tiles of 2 m, its back edge not in reach
        assert abs(y) < 0.3
        assert z == pytest.approx(ENV.robot.walking_height)
        again = require_start(ENV, terrain, (x, y, 0.0))
        np.testing.assert_allclose(again.position, start.position)


def test_an_invalid_start_is_refused_with_reason_amount_and_a_place_that_would_do():
    terrain = flat_map()
    terrain.heights[:, 60:63] = 1.0  # a wall across the map, at x from 1.95 to 2.25 m
    underside = min(box.low[2] for box in ENV.robot.trunk)
    deep = 1.0 - ENV.robot.walking_height - underside
    for start, reason in (
        ((-9.0, 0.0, 0.0), "off the map, which spans"),
        ((1.9, 0.5, 0.0), rf"at 0 deg collision C fails by {deep:.2f} m"),
        ((2.3, 0.5, 90.0), rf"at 90 deg collision C fails by {deep:.2f} m"),
    ):
        with pytest.raises(InputError, match=reason) as caught:
            require_start(ENV, terrain, start)
        x, y, yaw = map(float, str(caught.value).rsplit("place is ", 1)[1].split())
        assert require_start(ENV, terrain, (x, y, yaw)).position[0] == pytest.approx(x)
        if start[0] > 0.0:
            assert np.hypot(x - start[0], y - start[1]) < 1.0
    with pytest.raises(InputError, match="finite"):
        require_start(ENV, terrain, (float("nan"), 0.0, 0.0))


def test_where_nobody_can_stand_says_so():
    pillars = flat_map(half_size=1.0)
    pillars.heights[:] = np.nan
    pillars.heights[0, 0] = 0.0
    with pytest.raises(InputError, match="can stand nowhere"):
        choose_start(ENV, pillars)


def test_the_place_that_would_do_is_the_nearest_of_a_slow_search():
    terrain = flat_map()
    terrain.heights[:, 60:63] = 1.0
    places = Places(ENV, terrain)
    at, _ = nearest_place(places, np.array([1.9, 0.5]), 0.0)
    x_min, x_max, y_min, y_max = terrain.extent
    grid = np.stack(
        np.meshgrid(np.arange(x_min, x_max, 0.1), np.arange(y_min, y_max, 0.1)), axis=-1
    ).reshape(-1, 2)
    near = [each for each in np.round(grid, 2) if np.hypot(*(each - [1.9, 0.5])) < 1.5]
    valid = places.valid_anyhow(np.array(near))
    slow = min(
        float(np.hypot(*(each - [1.9, 0.5])))
        for each, good in zip(near, valid, strict=True)
        if good
    )
    assert np.hypot(*(np.array(at) - [1.9, 0.5])) == pytest.approx(slow, abs=1e-6)
