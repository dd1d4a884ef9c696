"""A network that does as the search did: the policy that a training can begin with."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from jaxleas.envs import Cases, numbers_of
from jaxleas.envs.gait_planning import GaitPlanning
from jaxleas.gaits.demonstrations import Demonstrations
from jaxleas.training import (
    ActorCritic,
    Policy,
    RunConfig,
    initial_normaliser,
    make_networks,
    normalise,
    policy_of,
)
from jaxleas.types import InputError

BATCH, LEARNING_RATE, DECAY = 1024, 2e-3, 1e-3
WIDTHS = np.repeat([0.05, 0.06, 0.05, 0.15], [3, 2, 8, 2]).astype(np.float32)
"""Noise added to turn and step, velocities, feet, and times before the tanh: what a training
explores with at first. The search leaves velocities and times nearly constant."""
NARROW, MOST = 0.03, 0.999
"""Width below which no number is foretold, and the largest number: its inverse tanh is finite."""
MEANINGLESS, OF_TIMES, OF_SUPPORT = 0.02, 0.3, 2.0
"""Weights of feet that are not placed, of times, and of the support."""


def imitate(
    config: RunConfig,
    task: GaitPlanning,
    shown: Demonstrations,
    passes: int,
    say: Callable[[int, float], None] = lambda done, loss: None,
) -> Policy:
    """Return a policy that is most likely to do as was shown, and as its mirror image.

    Args:
        config: configuration of the run that is to begin with it: its network and seed.
        task: gait planning.
        shown: demonstrations.
        passes: number of passes over them.
        say: function that is told after each pass its number and the mean loss.

    Raises:
        InputError: there are fewer demonstrations than one batch.
    """
    if len(shown) < BATCH:
        raise InputError(
            f"{len(shown)} transitions are too few to imitate: at least {BATCH}; search from more"
            " starts"
        )
    networks = make_networks(config.network, task.signature)
    rows = _with_mirror_images(networks, shown)
    steps = passes * (len(rows[0]) // BATCH)
    optimiser = optax.chain(
        optax.clip_by_global_norm(1.0),
        optax.adamw(optax.cosine_decay_schedule(LEARNING_RATE, steps), weight_decay=DECAY),
    )
    key = jax.random.key(config.seed)
    params = networks.actor.init(key)
    learn = jax.jit(_step_of(config, networks, optimiser))
    state, generator = optimiser.init(params), np.random.default_rng(config.seed)
    for done in range(1, passes + 1):
        order, losses = generator.permutation(len(rows[0])), []
        for begin in range(0, len(order) - BATCH + 1, BATCH):
            some = [column[order[begin : begin + BATCH]] for column in rows]
            noise = WIDTHS * generator.normal(size=some[1].shape).astype(np.float32)
            params, state, loss = learn(params, state, some, noise)
            losses.append(loss)
        say(done, float(jnp.stack(losses).mean()))
    normaliser = initial_normaliser(config.network, task.signature)
    return policy_of(networks, config.env, normaliser, params)


def _with_mirror_images(networks: ActorCritic, shown: Demonstrations) -> list[np.ndarray]:
    """Return observations, raw actions and weights of both."""
    signature = networks.signature
    raw = np.concatenate(
        [np.arctanh(shown.numbers.clip(-MOST, MOST)), shown.support[:, None]], axis=1
    ).astype(np.float32)
    count = len(shown)
    feet = np.where(np.repeat(shown.placed, 2, axis=1), 1.0, MEANINGLESS)
    base, times = np.ones((count, 5)), np.full((count, 2), OF_TIMES)
    weights = np.concatenate([base, feet, times], axis=1).astype(np.float32)
    head = _head_of(networks)
    image = np.asarray(head.mirrored_raw(jnp.asarray(raw)))
    # A mirror swaps feet, and weights have no sign.
    swapped = np.abs(np.asarray(head.numbers.mirrored_raw(jnp.asarray(weights))))
    seen = np.asarray(signature.mirror(jnp.asarray(shown.observation)))
    return [
        np.concatenate([shown.observation, seen]),
        np.concatenate([raw[:, :-1], image[:, :-1]]),
        np.concatenate([raw[:, -1], image[:, -1]]),
        np.concatenate([weights, swapped]),
    ]


def _head_of(networks: ActorCritic) -> Cases:
    (head,) = networks.signature.heads
    assert isinstance(head, Cases)  # demonstrations name supports
    return head


def _step_of(
    config: RunConfig, networks: ActorCritic, optimiser: optax.GradientTransformation
) -> Callable[..., tuple[Any, Any, Array]]:
    normaliser = initial_normaliser(config.network, networks.signature)
    head = _head_of(networks)

    def loss_of(params: Any, rows: list[Array], noise: Array) -> Array:
        observation, numbers, support, weights = rows
        seen = jax.vmap(lambda row: normalise(row, normaliser))(observation)
        answer = networks.answer(params, seen)
        (cases,) = networks.signature.distributions(answer)
        phase = numbers_of(cases, support)
        deviation = jnp.sqrt(jnp.square(phase.deviation) + NARROW**2)
        distance = (numbers + noise - phase.location) / deviation
        unlikely = 0.5 * jnp.square(distance) + jnp.log(deviation)
        picked = head.choice.log_density(support[:, None], cases.choice)
        return jnp.mean(jnp.sum(weights * unlikely, axis=1)) - OF_SUPPORT * jnp.mean(picked)

    def step(params: Any, state: Any, rows: list[Array], noise: Array) -> tuple[Any, Any, Array]:
        loss, slope = jax.value_and_grad(loss_of)(params, rows, noise)
        change, state = optimiser.update(slope, state, params)
        return optax.apply_updates(params, change), state, loss

    return step
