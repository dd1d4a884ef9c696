"""Networks to begin a training with: the actor of a policy file, beside an untrained critic."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.training.config import RunConfig
from jaxleas.training.networks import ActorCritic
from jaxleas.training.normaliser import initial_normaliser
from jaxleas.training.policy import read_policy
from jaxleas.training.train_state import Learned, TrainState
from jaxleas.types import InputError


def actor_to_begin_with(config: RunConfig, networks: ActorCritic) -> Any:
    """Return the parameters of the policy that a run's configuration begins with.

    Args:
        config: configuration of the run, whose `begin` names a policy file.
        networks: actor and critic of the run.

    Raises:
        InputError: the file is no policy of this task, or of a network of another kind or size.
    """
    policy = read_policy(config.begin, of=config.env)
    if config.network.normaliser == "running":
        raise InputError(
            "begin: a policy file holds no running statistics to continue: set network.normaliser:"
            " affine"
        )
    scaling = initial_normaliser(config.network, networks.signature)
    mean, deviation = map(networks.signature.for_actor, (scaling.mean, scaling.std))
    same_scales = np.allclose(policy.mean, mean) and np.allclose(policy.deviation, deviation)
    wanted = jax.eval_shape(networks.actor.init, jax.random.key(0))
    shapes = [jax.tree.map(jnp.shape, each) for each in (policy.params, wanted)]
    if not same_scales or policy.network.activation != networks.actor.activation:
        raise InputError(
            f"begin: {config.begin} was trained with other scales of its observation, or another"
            " activation: network and env must be those of its own run"
        )
    if jax.tree.structure(shapes[0]) != jax.tree.structure(shapes[1]) or shapes[0] != shapes[1]:
        raise InputError(
            f"begin: the network of {config.begin} is of other sizes than network.hidden ="
            f" {list(config.network.hidden)} of this run"
        )
    return policy.params


def begun_with(config: RunConfig, networks: ActorCritic, state: TrainState) -> Learned | None:
    """Return the networks that a run begins with; None where its configuration names none.

    Args:
        config: configuration of the run.
        networks: actor and critic of the run.
        state: fresh state of the run, whose critic is kept.
    """
    if not config.begin:
        return None
    actor = actor_to_begin_with(config, networks)
    averaged = jax.tree.map(jnp.copy, actor)  # a buffer of its own: both are given away
    params = state.params.replace(policy=actor)
    return Learned(params=params, averaged=averaged, normaliser=state.normaliser)
