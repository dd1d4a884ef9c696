"""Let a policy see more than it was trained with: new inputs start with weights of zero."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp

from jaxleas.distillation.config import SteeringRun
from jaxleas.envs.steering import SteeringConfig, SteeringEnv, layout_named
from jaxleas.training import Learned, Policy, initial_normaliser
from jaxleas.types import InputError

_FIRST_LAYER = "hidden_0"


def widen(
    config: SteeringRun, learned: Learned, observation: str | None
) -> tuple[SteeringRun, Learned]:
    """Return a run's configuration and networks for another observation layout.

    Their behaviour is unchanged: the layout has the old one's values first, and the values that it
    adds have no effect before they are learned from.

    Args:
        config: configuration of the run.
        learned: networks learned by the run.
        observation: name of the layout; None keeps the run's own.

    Raises:
        InputError: the layout does more than add to the run's, or the normaliser is a running one,
            which has no statistics of the new values.
    """
    if observation is None or observation == config.env.observation:
        return config, learned
    env = SteeringConfig.model_validate(config.env.model_dump() | {"observation": observation})
    before, after = layout_named(config.env.observation), layout_named(observation)
    if (before.rows, before.columns) != (after.rows, after.columns) or after.size < before.size:
        raise InputError(
            f"a policy that sees {before.name} cannot be continued with practice.observation ="
            f" {observation}, which does not only add to it: train one with env.observation ="
            f" {observation}"
        )
    if config.network.normaliser != "affine":
        raise InputError(
            f"practice.observation = {observation} needs a policy with network.normaliser = affine,"
            f" not {config.network.normaliser}"
        )
    changed = config.model_copy(update={"env": env})
    added = after.size - before.size
    wider = Learned(
        params=learned.params.replace(
            policy=_wider(learned.params.policy, added), value=_wider(learned.params.value, added)
        ),
        averaged=_wider(learned.averaged, added),
        normaliser=initial_normaliser(config.network, env.signature()),
    )
    return changed, wider


def widen_policy(policy: Policy, env: SteeringEnv) -> Policy:
    """Return a policy that walks in an environment whose observation only adds to its own.

    Args:
        policy: trained policy.
        env: environment whose observation `widen` has accepted.
    """
    added = env.layout.size - len(policy.mean)
    if not added:
        return policy
    signature = env.config.signature()
    mean, deviation = signature.scaling
    return Policy(
        mean=jnp.asarray(mean),
        deviation=jnp.asarray(deviation),
        params=_wider(policy.params, added),
        network=replace(policy.network, inputs=signature.size),  # type: ignore[type-var]
        signature=signature,
        config=policy.config.model_copy(update={"observation": env.config.observation}),
    )


def _wider(params: Any, added: int) -> Any:
    """Return a network's parameters with `added` more inputs, of weight zero."""
    layers = dict(params["params"])
    first = dict(layers[_FIRST_LAYER])
    kernel = first["kernel"]
    first["kernel"] = jnp.concatenate([kernel, jnp.zeros((added, kernel.shape[1]), kernel.dtype)])
    layers[_FIRST_LAYER] = first
    return jax.tree.map(jnp.asarray, {**params, "params": layers})
