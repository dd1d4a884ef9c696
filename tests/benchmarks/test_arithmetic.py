"""The least work of a step, and the bound it makes."""

import dataclasses

import jax
import jax.numpy as jnp
import pytest

from benchmarks.arithmetic import (
    Rates,
    env_limit,
    env_words,
    forward_flops,
    gradient_flops,
    layers,
    ppo_limit,
    step_work,
)
from benchmarks.context import changed
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.training.run_config import run_config_of

RunConfig = run_config_of("steering")


RATES = Rates(matrix=1e11, memory=1e10, gather=1e9)


def test_the_thesis_networks_by_hand():
    actor = layers(144, (128, 64, 32), 8)
    assert actor == [(144, 128), (128, 64), (64, 32), (32, 8)]
    assert forward_flops(actor) == 2 * (18_432 + 8_192 + 2_048 + 256) == 57_856
    assert gradient_flops(actor) == 3 * 57_856 - 2 * 18_432
    work = step_work(RunConfig(), SteeringEnv(SteeringConfig()))
    critic = 2 * (18_432 + 8_192 + 2_048 + 32)
    assert work.learn_flops == 4 * (3 * 57_856 + 3 * critic - 4 * 18_432)
    assert work.flops == 57_856 + work.learn_flops == 1_146_112
    # An observation is written once and read once an epoch.
    assert work.learn_bytes == 144 * 5 * 4
    low = changed(RunConfig(), network={"products": "bfloat16"})
    assert step_work(low, SteeringEnv(SteeringConfig())).learn_bytes == 144 * (4 + 4 * 2)


@pytest.mark.parametrize("sizes", [(144, 128, 64, 32, 8), (81, 64, 64, 1), (20, 30, 10)])
def test_flops_are_those_that_the_compiler_counts(sizes):
    network = layers(sizes[0], sizes[1:-1], sizes[-1])
    samples = 512
    kernels = [jnp.ones(shape) for shape in network]

    def apply(kernels, value):
        for kernel in kernels:
            value = value @ kernel
        return jnp.sum(value * value)

    data = jnp.ones((samples, sizes[0]))
    cost = jax.jit(jax.grad(apply)).lower(kernels, data).compile().cost_analysis()
    assert cost is not None
    assert cost["flops"] == pytest.approx(samples * gradient_flops(network), rel=0.02)


def test_words_of_a_step_by_hand():
    env = SteeringEnv(SteeringConfig())
    points = 140 + 28  # the observation's grid and the footprint
    # Heights; observation, reward; motion and counters, in and out; plan; action.
    assert env_words(env) == points + 145 + 2 * 10 + 13 + 4


def test_more_work_lowers_the_bound():
    env, config = SteeringEnv(SteeringConfig()), RunConfig()
    base = ppo_limit(step_work(config, env), RATES)
    fewer_epochs = changed(config, ppo={"epochs": 2})
    wider = changed(config, network={"hidden": (256, 128)})
    assert ppo_limit(step_work(fewer_epochs, env), RATES) > 1.5 * base
    assert ppo_limit(step_work(wider, env), RATES) < base
    smaller = SteeringEnv(SteeringConfig(observation="icra81"))
    assert env_limit(step_work(config, smaller), RATES) > env_limit(step_work(config, env), RATES)


@pytest.mark.parametrize("name", ["matrix", "memory", "gather"])
def test_a_faster_machine_never_lowers_the_bound(name):
    work = step_work(RunConfig(), SteeringEnv(SteeringConfig()))
    faster = dataclasses.replace(RATES, **{name: 2.0 * getattr(RATES, name)})
    assert ppo_limit(work, faster) >= ppo_limit(work, RATES)
    assert env_limit(work, faster) >= env_limit(work, RATES)
    doubled = Rates(*(2.0 * rate for rate in dataclasses.astuple(RATES)))
    assert ppo_limit(work, doubled) == pytest.approx(2.0 * ppo_limit(work, RATES))


def test_the_bound_is_below_each_of_its_parts():
    work = step_work(RunConfig(), SteeringEnv(SteeringConfig()))
    limit = ppo_limit(work, RATES)
    assert limit < RATES.matrix / work.flops
    assert limit < env_limit(work, RATES) <= RATES.gather / work.env_heights
    assert env_limit(work, RATES) <= RATES.memory / work.env_bytes
