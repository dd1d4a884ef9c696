"""Room that is left in training: what is valid there is valid without it, and some room farther."""

import numpy as np

from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.terrain import HeightMap, make_atlas
from jaxleas.types import RootMotion

from .compiled import margin

CONFIG = SteeringConfig(outline_spacing=0.05)
SPARE = 0.03
PLAIN, STRICT = SteeringEnv(CONFIG), SteeringEnv(CONFIG, spare=SPARE)
COUNT = 4000


def at_rest(position, yaw):
    return RootMotion(*map(np.float32, (position, 0.0 * position, yaw)))


def valid(env, atlas, motion):
    return np.asarray(margin(env, atlas, np.zeros(len(motion.yaw), np.int32), motion)) >= 0.0


def test_room_is_left_to_walls_and_edges():
    """A wall from x = 0 on, or ground that ends there; the root comes closer, facing it."""
    cell = 0.01
    x = np.arange(-150, 150) * cell + 0.5 * cell
    wall = np.where(x > 0.0, 1.5, 0.0).astype(np.float32)
    ledge = np.where(x > 0.0, np.nan, 0.0).astype(np.float32)
    place = np.linspace(-0.4, 0.3, 701)
    position = np.stack([place, 0.0 * place, 0.95 + 0.0 * place], axis=-1)
    motion = at_rest(position, 0.0 * place)
    for row in (wall, ledge):
        atlas = make_atlas([HeightMap(np.tile(row, (300, 1)), cell, (float(x[0]), -1.5))])
        closest = [place[valid(env, atlas, motion)].max() for env in (PLAIN, STRICT)]
        assert closest[0] - closest[1] == np.clip(
            closest[0] - closest[1], SPARE - cell, SPARE + cell
        )


def test_what_is_valid_with_room_to_spare_is_valid():
    rng = np.random.default_rng(0)
    blocks = np.kron(rng.uniform(0.0, 0.2, (12, 12)), np.ones((10, 10)))
    posts = np.kron(rng.uniform(size=(60, 60)) < 0.01, np.ones((2, 2))) > 0.0
    blocks[posts] = 1.0  # 8 cm thick: none passes between points 5 cm apart
    atlas = make_atlas([HeightMap(blocks.astype(np.float32), 0.04, (-2.4, -2.4))])
    place = np.column_stack([rng.uniform(-2, 2, (COUNT, 2)), rng.uniform(0.85, 1.1, COUNT)])
    motion = at_rest(place, rng.uniform(-np.pi, np.pi, COUNT))
    plain, strict = (valid(env, atlas, motion) for env in (PLAIN, STRICT))
    assert 0.1 < strict.mean() < plain.mean()
    assert not (strict & ~plain).any()


def test_feelers_and_observation_do_not_change():
    config = CONFIG.model_copy(update={"observation": "feelers169"})
    plain, strict = SteeringEnv(config), SteeringEnv(config, spare=SPARE)
    assert plain.sight.feelers is not None
    assert strict.sight.feelers is not None
    np.testing.assert_array_equal(
        plain.sight.feelers.points_in_root, strict.sight.feelers.points_in_root
    )
