"""The least work of a step: floating-point operations and bytes, computed from sizes."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import jax.numpy as jnp

from jaxleas.envs.steering import ACTION_SIZE, GOALS, SteeringEnv
from jaxleas.training import AnyRun

FLOAT = 4  # bytes
LOGITS = 2 * ACTION_SIZE  # a mean and a deviation for each component of an action


def layers(inputs: int, hidden: Sequence[int], outputs: int) -> list[tuple[int, int]]:
    """Return the (inputs, outputs) of each layer of a network."""
    return list(itertools.pairwise([inputs, *hidden, outputs]))


def weights(network: Sequence[tuple[int, int]]) -> int:
    """Return the number of weights, without biases."""
    return sum(rows * columns for rows, columns in network)


def forward_flops(network: Sequence[tuple[int, int]]) -> int:
    """Return the operations of a network on one sample: a product and a sum per weight."""
    return 2 * weights(network)


def gradient_flops(network: Sequence[tuple[int, int]]) -> int:
    """Return the operations of one sample's part in a gradient, the forward pass included.

    Three products per layer: forward, gradient of the weights, gradient of the inputs; the first
    layer's inputs are data and need no gradient.
    """
    return 3 * forward_flops(network) - forward_flops(network[:1])


@dataclass(frozen=True)
class StepWork:
    """The least work of one environment step in training.

    Only what every implementation needs is counted: activations, Adam, advantages, resets,
    random numbers and the bootstrap value are left out, so the bound is never too low.

    Attributes:
        walk_flops: operations of matrix products while walking: the actor, once.
        learn_flops: operations of matrix products while learning: both gradients, once per epoch.
        learn_bytes: bytes of the observation, written once and read once per epoch.
        env_bytes: bytes of the environment alone: heights, observation, state and action.
        env_heights: number of heights gathered from the atlas.
    """

    walk_flops: int
    learn_flops: int
    learn_bytes: int
    env_bytes: int
    env_heights: int

    @property
    def flops(self) -> int:
        """Operations of all matrix products."""
        return self.walk_flops + self.learn_flops


def step_work(config: AnyRun, env: SteeringEnv) -> StepWork:
    """Return the least work of a step: for this network, observation and number of epochs."""
    size, hidden = env.layout.size, config.network.hidden
    actor, critic = layers(size, hidden, LOGITS), layers(size, hidden, 1)
    epochs = config.ppo.epochs
    return StepWork(
        walk_flops=forward_flops(actor),
        learn_flops=epochs * (gradient_flops(actor) + gradient_flops(critic)),
        learn_bytes=size * (FLOAT + epochs * jnp.dtype(config.network.product_type).itemsize),
        env_bytes=FLOAT * env_words(env),
        env_heights=len(env.points_in_root),
    )


def env_words(env: SteeringEnv) -> int:
    """Return the least number of four-byte words that one step of one robot reads or writes."""
    motion, counters = 7, 3  # position, velocity, yaw; goal, its age, steps of the episode
    plan = 1 + GOALS * 3  # map; goals and their durations: read, seldom written
    heights = len(env.points_in_root)
    outcome = env.layout.size + 1  # observation and reward
    return heights + outcome + 2 * (motion + counters) + plan + ACTION_SIZE


@dataclass(frozen=True)
class Rates:
    """The measured rates of the machine, all its cores together.

    Attributes:
        matrix: floating-point operations in matrix products [1/s].
        memory: bytes read or written [1/s].
        gather: heights gathered from the atlas [1/s].
    """

    matrix: float
    memory: float
    gather: float


def env_limit(work: StepWork, rates: Rates) -> float:
    """Return the largest number of environment steps per second that the machine allows."""
    return 1.0 / _env_seconds(work, rates)


def ppo_limit(work: StepWork, rates: Rates) -> float:
    """Return the largest number of training steps per second that the machine allows.

    Walking and learning follow each other, so their times add up; within each, arithmetic and
    memory traffic may overlap, so the longer counts.
    """
    walk = _env_seconds(work, rates) + work.walk_flops / rates.matrix
    learn = max(work.learn_flops / rates.matrix, work.learn_bytes / rates.memory)
    return 1.0 / (walk + learn)


def _env_seconds(work: StepWork, rates: Rates) -> float:
    return max(work.env_heights / rates.gather, work.env_bytes / rates.memory)
