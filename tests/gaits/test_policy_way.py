"""Ways of a policy: every phase is one that the task accepts, and draws lead farther."""

from dataclasses import replace

import jax
import numpy as np
import pytest

from jaxleas.envs.gait_planning import (
    GaitPlanning,
    GaitPlanningConfig,
    GaitWorldsConfig,
    footholds_are_safe,
)
from jaxleas.gaits import NO_RETRIES, Retries, taken, walk_policy
from jaxleas.gaits.on_terrain import OnTerrain
from jaxleas.training import initial_normaliser, make_networks, policy_of
from jaxleas.training.config import NetworkConfig
from tests.gaits.worlds import with_gap

CONFIG = GaitPlanningConfig(snap=0.1, placing="feet_first")
MOST = 10


@pytest.fixture(scope="module")
def untrained():
    network = NetworkConfig(hidden=(16,))
    signature = CONFIG.signature()
    networks = make_networks(network, signature)
    params = networks.actor.init(jax.random.key(2))
    return policy_of(networks, CONFIG, initial_normaliser(network, signature), params)


@pytest.fixture(scope="module")
def place():
    place = OnTerrain(CONFIG, with_gap(0.16))
    return place.footing.ground, place.stand((0.5, 2.0, 0.0), (2.2, 2.0))


def walked(policy, place, retries):
    return walk_policy(policy, *place, MOST, retries)


def test_draws_lead_farther_than_the_policy_alone(untrained, place):
    alone = walked(untrained, place, NO_RETRIES)
    drawn = walked(untrained, place, Retries(15, 3))
    assert alone.gait.ending == "refused"
    assert alone.cause
    assert alone.programs == len(alone.gait.commands.turn) + 1
    assert len(drawn.gait.commands.turn) > len(alone.gait.commands.turn)
    assert drawn.programs > len(drawn.gait.commands.turn)


def test_the_same_seed_gives_the_same_way_and_another_one_another(untrained, place):
    ways = [walked(untrained, place, Retries(15, 3, seed)).gait.states for seed in (0, 0, 1)]
    jax.tree.map(np.testing.assert_array_equal, ways[0], ways[1])
    assert not np.array_equal(ways[0].phase.com[:4], ways[2].phase.com[:4])


def test_every_phase_is_one_that_the_task_accepts(untrained, place):
    ground, _ = place
    gait = walked(untrained, place, Retries(15, 3)).gait
    task = GaitPlanning(CONFIG, GaitWorldsConfig())
    before, after = (taken(gait.states, part) for part in (slice(None, -1), slice(1, None)))
    asked = np.ones(len(gait.commands.turn), bool)
    feasible, _ = task.decide(before.phase, after.phase, gait.commands.times, asked)
    assert feasible.all()
    assert footholds_are_safe(ground, after.field, after.phase).all()


def test_a_way_ends_where_going_back_does_not_help(untrained, place):
    ground, start = place
    nowhere = replace(ground, safe=np.zeros_like(ground.safe), nearest=None)
    way = walk_policy(untrained, nowhere, start, MOST, Retries(7, 3))
    assert way.gait.ending == "refused"
    assert len(way.gait.commands.turn) == 0
    assert way.programs == 1 + 4 * 7
    assert way.cause == "a foothold is too near an edge"
