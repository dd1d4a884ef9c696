"""A surrogate in the environment: when it looks, what it remembers, how often it ends a walk."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.surrogates import Surrogate, SurrogateForesight
from jaxleas.surrogates.features import MOTION_FEATURES, path_features
from jaxleas.surrogates.network import initial_weights
from jaxleas.surrogates.turns import GROUP
from jaxleas.types import InputError, RootMotion

from .walkers import KEEP_EVERY, env, identity

POINTS = len(env().points_in_root)
NEAR = identity().near


def surrogate(hazard=None, seed=0):
    weights = initial_weights(jax.random.key(seed), len(NEAR) + MOTION_FEATURES, 8, 6)
    if hazard is None:
        head = jax.random.normal(jax.random.key(1), weights.head.shape)
        weights = weights.replace(head=head, head_bias=jnp.float32(-1.0))
    else:
        weights = weights.replace(head_bias=jnp.float32(np.log(hazard / (1 - hazard))))
    return Surrogate(weights, jnp.float32(1.0), jnp.float32(0.0), identity())


def walk(count, steps, seed=0):
    """Root motions and local heights of a random walk, one after another."""
    generator = np.random.default_rng(seed)
    for step in range(steps + 1):
        yield (
            np.float32(generator.uniform(-1.4, -0.2, (count, POINTS))),
            RootMotion(
                np.float32(generator.normal(size=(count, 3)) + 0.02 * step),
                np.float32(0.1 * generator.normal(size=(count, 3))),
                np.float32(generator.uniform(-3, 3, count)),
            ),
        )


def standing_still(count):
    """Heights of level ground, and motions at rest."""
    rest = np.zeros((count, 3), np.float32)
    return np.full((count, POINTS), -0.95, np.float32), RootMotion(rest, rest, rest[:, 0])


@partial(jax.jit, static_argnums=0)
def begin(judge, heights, motion, chance):
    return judge.begin(heights, motion, chance)


@partial(jax.jit, static_argnums=0)
def follow(judge, memory, heights, motion):
    return judge.follow(memory, around(heights), motion)


def around(heights):
    """What shows these heights."""
    return lambda pick, points: pick(heights)[..., points]


@jax.jit
def shown(heights, motion, last):
    """Features of a kept configuration."""
    return path_features(heights[:, NEAR], motion, last, KEEP_EVERY, (-1.4, -0.2))


def test_survival_is_the_product_over_kept_configurations_alone():
    judge, one = SurrogateForesight(surrogate()), surrogate()
    steps = list(walk(4, 3 * KEEP_EVERY))
    margin, memory = begin(judge, *steps[0], np.full(4, 0.25, np.float32))
    look_once = jax.jit(one.hazard)
    hidden, last, survival = one.begin((4,)), steps[0][1], np.ones(4)
    for number, (heights, motion) in enumerate(steps):
        if number:
            margin, memory = follow(judge, memory, heights, motion)
        if number % KEEP_EVERY == 0:
            features = shown(heights, motion, last)
            hidden, hazard = look_once(hidden, features)
            survival, last = survival * (1 - np.asarray(hazard)), motion
        np.testing.assert_allclose(margin, survival - 0.25, atol=1e-5)
    assert np.all(survival < 0.95)  # the test is not about ones


def test_walks_end_as_often_as_the_hazard_says():
    count, hazard = 20_000, 0.2
    judge = SurrogateForesight(surrogate(hazard))
    chance = jax.random.uniform(jax.random.key(5), (count,))
    heights, still = standing_still(count)
    margin, memory = begin(judge, heights, still, chance)
    for kept in range(1, 4):
        assert np.mean(np.asarray(margin) < 0) == pytest.approx(1 - (1 - hazard) ** kept, abs=0.012)
        for _ in range(KEEP_EVERY):
            margin, memory = follow(judge, memory, heights, still)


def test_the_risk_dial_ends_what_has_become_too_unsure():
    judge = SurrogateForesight(surrogate(0.2), threshold=0.9)
    margin, _ = begin(judge, *standing_still(3), np.float32([0.0, 0.5, 0.99]))
    assert np.all(np.asarray(margin) < 0.0)
    with pytest.raises(InputError, match=r"threshold is 1\.0"):
        SurrogateForesight(surrogate(), threshold=1.0)


@pytest.mark.slow
def test_in_turns_everybody_is_judged_as_ever_once_their_times_are_apart():
    """Twins: who is served late at first is served on time from then on, by the same network."""
    count, one = 2 * GROUP, surrogate()
    judge = SurrogateForesight(one, queue=True)
    steps = list(walk(count, 3 * KEEP_EVERY))
    _, memory = judge.begin(*steps[0], jnp.zeros(count))
    hidden, hazard = one.hazard(one.begin((count,)), shown(*steps[0], steps[0][1]))
    survival, last, since, served_at = 1.0 - hazard, steps[0][1], np.zeros(count, int), []
    for heights, motion in steps[1:]:
        margin, memory = judge.follow(memory, around(heights), motion)
        since += 1
        served = np.asarray(memory.since) == 0
        assert np.all(since[served] >= KEEP_EVERY)
        since[served] = 0
        served_at.append(served)
        after, hazard = one.hazard(hidden, shown(heights, motion, last))
        hidden = jnp.where(served[:, None], after, hidden)
        survival = np.where(served, survival * (1.0 - hazard), survival)
        last = RootMotion(
            jnp.where(served[:, None], motion.position, last.position),
            jnp.where(served[:, None], motion.velocity, last.velocity),
            jnp.where(served, motion.yaw, last.yaw),
        )
        np.testing.assert_allclose(margin, survival, atol=1e-5)
        np.testing.assert_allclose(memory.hidden, hidden, atol=1e-5)
    served_at = np.array(served_at)
    assert not served_at[: KEEP_EVERY - 1].any()
    assert 0.2 < served_at[KEEP_EVERY - 1].mean() < 0.5  # all were due, and waited in a queue
    assert served_at[KEEP_EVERY - 1 : 2 * KEEP_EVERY - 1].sum(axis=0).tolist() == [1] * count
    assert (served_at[2 * KEEP_EVERY :].sum(axis=0) >= 1).all()


def test_in_turns_costs_what_the_few_who_are_due_cost():
    looked = []
    judge = SurrogateForesight(surrogate(), queue=True)
    heights, still = standing_still(2 * GROUP)
    _, memory = begin(judge, heights, still, np.zeros(2 * GROUP, np.float32))

    def look_around(pick, points):
        looked.append(pick(heights)[:, points])
        return looked[0]

    jax.jit(lambda memory: judge.follow(memory, look_around, still))(memory)
    assert looked[0].size < 0.35 * len(heights) * len(NEAR)
    assert 0 < len(NEAR) < 0.6 * POINTS
