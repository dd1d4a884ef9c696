import json

import jax
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.files import write_npz
from jaxleas.training.config import NetworkConfig
from jaxleas.training.networks import make_networks
from jaxleas.training.normaliser import initial_normaliser
from jaxleas.training.policy import policy_of, read_policy, write_policy
from jaxleas.types import InputError

from ..probes.drift import DriftConfig
from .test_loss import brax_networks


@pytest.fixture(scope="module")
def env():
    return SteeringEnv(SteeringConfig())


def make(env, activation="relu"):
    config = NetworkConfig(hidden=(16, 8), activation=activation)
    networks = make_networks(config, env.config.signature())
    params = networks.actor.init(jax.random.key(0))
    normaliser = initial_normaliser(config, networks.signature)
    return config, normaliser, params, policy_of(networks, env.config, normaliser, params)


@pytest.mark.parametrize("activation", ["relu", "tanh", "swish", "elu"])
def test_the_policy_is_the_mode_of_braxs_network(env, activation, brax_ranks):
    config, normaliser, params, policy = make(env, activation)
    networks = brax_networks(config)
    observation = jax.random.normal(jax.random.key(1), (50, env.layout.size)) * 3
    logits = networks.policy_network.apply(normaliser, params, observation)
    mode = networks.parametric_action_distribution.mode(logits)
    np.testing.assert_allclose(policy.action(observation), mode, atol=2e-6)


def test_a_command_keeps_the_limits(env):
    policy = make(env)[-1]
    observation = jax.random.normal(jax.random.key(2), (200, env.layout.size)) * 50
    command = np.asarray(policy(observation))
    assert np.all(
        np.linalg.norm(command[:, :3], axis=1) <= policy.config.limits.max_acceleration * 1.0001
    )
    assert np.all(np.abs(command[:, 3]) <= policy.config.limits.max_turn_rate * 1.0001)


def test_a_file_gives_the_same_policy_back(env, tmp_path):
    policy = make(env)[-1]
    write_policy(tmp_path / "policy.npz", policy)
    again = read_policy(tmp_path / "policy.npz")
    observation = jax.random.normal(jax.random.key(3), (7, env.layout.size))
    np.testing.assert_array_equal(again(observation), policy(observation))
    assert again.config == policy.config


def test_files_that_are_no_policy_are_refused(env, tmp_path):
    path = tmp_path / "policy.npz"
    with pytest.raises(InputError, match="does not exist"):
        read_policy(path)
    path.write_bytes(b"PK\x03\x04 nothing of the kind")
    with pytest.raises(InputError, match="not a readable"):
        read_policy(path)
    write_npz(path, kernel_0=np.zeros(3))
    with pytest.raises(InputError, match="lacks the array"):
        read_policy(path)


def test_a_policy_of_another_shape_or_format_is_refused(env, tmp_path):
    path = tmp_path / "policy.npz"
    write_policy(path, make(env)[-1])
    with np.load(path) as archive:
        arrays = dict(archive)
    metadata = json.loads(str(arrays["metadata"]))

    def rewritten(**changes):
        write_npz(path, **(arrays | changes))
        return path

    with pytest.raises(InputError, match="format 99"):
        read_policy(rewritten(metadata=np.array(json.dumps(metadata | {"format": 99}))))
    with pytest.raises(InputError, match="no policy for the 144 values"):
        read_policy(rewritten(kernel_0=np.zeros((81, 16), np.float32)))
    wrong = metadata | {"activation": "__import__"}
    with pytest.raises(InputError, match="activation"):
        read_policy(rewritten(metadata=np.array(json.dumps(wrong))))


def test_a_policy_of_another_task_is_refused_where_one_task_is_wanted(env, tmp_path):
    path = tmp_path / "policy.npz"
    write_policy(path, make(env)[-1])
    assert read_policy(path, of=SteeringConfig).config == env.config
    assert read_policy(path, of=env.config).config == env.config
    other = DriftConfig(task="renamed:Drift")  # a task may be named otherwise than by default
    for wanted, said in ((DriftConfig, "tests.probes.drift:Drift"), (other, "renamed:Drift")):
        with pytest.raises(InputError, match=f"of the task steering; one of {said} would do"):
            read_policy(path, of=wanted)
