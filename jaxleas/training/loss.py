"""The loss of proximal policy optimisation, as Brax computes it, arranged for speed.

`tests/training/test_loss.py` holds values and gradients to Brax's `compute_ppo_loss`. What is
arranged otherwise: observations come normalised, once for both networks; the tanh's Jacobian, the
same under the old and the new policy, is left out of their ratio.
"""

from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs import NormalDistribution
from jaxleas.training.averages import ONE_DEVICE, Average
from jaxleas.training.networks import ActorCritic

# Metrics that are the largest or the smallest of all robots; all others are means.
LARGEST = ("policy_dist_max_std", "policy_dist_max_loc")
SMALLEST = ("policy_dist_min_std", "policy_dist_min_loc")


@struct.dataclass
class Experience:
    """The experience of a roll-out, or a minibatch of it.

    Attributes:
        observation: observation before each step [physical units].
        raw_action: raw action of all heads.
        distributions: distribution of each head, from which the raw action was drawn.
        reward: reward for the step.
        terminated: 1 where the episode failed with this step, else 0.
        truncated: 1 where the episode was cut, else 0.
    """

    observation: Float[Array, "time robots size"]
    raw_action: Float[Array, "time robots action_size"]
    distributions: tuple[Any, ...]
    reward: Float[Array, "time robots"]
    terminated: Float[Array, "time robots"]
    truncated: Float[Array, "time robots"]


@struct.dataclass
class Minibatch:
    """Experience of some robots, as the loss takes it.

    Attributes:
        steps: their experience, with normalised observations.
        last_observation: their normalised observation after the last step, to bootstrap from.
        noise: standard normal numbers for each head, to sample the entropy with.
    """

    steps: Experience
    last_observation: Float[Array, "robots size"]
    noise: tuple[Float[Array, "time robots entropy_noise"], ...]


def advantages(
    steps: Experience,
    values: Float[Array, "time robots"],
    last_value: Float[Array, " robots"],
    hyper: Any,
) -> tuple[Float[Array, "time robots"], Float[Array, "time robots"]]:
    """Return targets of the critic and generalised advantages (Schulman et al. 2016).

    Nothing follows a termination. What follows a truncation was not seen, so that nothing is
    learned from such a step.

    Args:
        steps: experience, of which rewards and ends are read.
        values: value of each observation.
        last_value: value of the observation after the last step.
        hyper: hyperparameters discount (gamma), gae_lambda (lambda) and reward_scale.
    """
    reward = steps.reward * hyper.reward_scale
    seen = 1.0 - steps.truncated
    future = hyper.discount * (1.0 - steps.terminated)
    following = jnp.concatenate([values[1:], last_value[None]])
    delta = seen * (reward + future * following - values)
    decay = hyper.gae_lambda * seen * future

    def join(later: tuple[Array, Array], earlier: tuple[Array, Array]) -> tuple[Array, Array]:
        return earlier[0] * later[0], earlier[1] + earlier[0] * later[1]

    # error = delta + decay * next error, for all times in log(time) passes: sequentially, each time
    # would be a launch on a GPU, where a whole minibatch takes no longer than a few launches.
    _, errors = jax.lax.associative_scan(join, (decay, delta), reverse=True)
    targets = errors + values
    following = jnp.concatenate([targets[1:], last_value[None]])
    return targets, seen * (reward + future * following - values)


def ppo_loss(
    params: Any,
    batch: Minibatch,
    hyper: Any,
    networks: ActorCritic,
    average: Average = ONE_DEVICE,
) -> tuple[Array, dict[str, Array]]:
    """Return the loss and its metrics.

    Args:
        params: parameters of actor and critic.
        batch: experience to learn from.
        hyper: hyperparameters discount, gae_lambda, clip, entropy, value_weight and reward_scale.
        networks: actor and critic.
        average: average over the devices that hold robots of this minibatch.
    """
    heads, steps = networks.signature.heads, batch.steps
    now = networks.signature.distributions(networks.answer(params.policy, steps.observation))
    values = networks.values(params.value, steps.observation)
    last_value = networks.values(jax.lax.stop_gradient(params.value), batch.last_observation)
    targets, advantage = advantages(steps, jax.lax.stop_gradient(values), last_value, hyper)
    advantage = average.standardised(advantage)
    raw = networks.signature.raw(steps.raw_action)
    before = steps.distributions
    ratio = jnp.exp(_log_density(heads, raw, now) - _log_density(heads, raw, before))
    clipped = jnp.clip(ratio, 1.0 - hyper.clip, 1.0 + hyper.clip)
    policy_loss = -jnp.mean(jnp.minimum(ratio * advantage, clipped * advantage))
    value_loss = 0.5 * hyper.value_weight * jnp.mean(jnp.square(targets - values))
    entropy = _total(
        [head.entropy(*each) for head, *each in zip(heads, now, batch.noise, strict=True)]
    )
    entropy_loss = -hyper.entropy * jnp.mean(entropy)
    total = policy_loss + value_loss + entropy_loss
    divergence = [head.divergence(*each) for head, *each in zip(heads, before, now, strict=True)]
    return total, {
        "total_loss": total,
        "policy_loss": policy_loss,
        "v_loss": value_loss,
        "entropy_loss": entropy_loss,
        "kl_mean": jnp.mean(_total(divergence)),
        **_spread(now),
    }


def _log_density(heads: Any, raw: Any, distributions: Any) -> Array:
    return _total(
        [head.log_density(*each) for head, *each in zip(heads, raw, distributions, strict=True)]
    )


def _total(each: list[Array]) -> Array:
    """Return the sum over the heads: they are independent of each other."""
    whole = each[0]
    for other in each[1:]:
        whole = whole + other
    return whole


def _spread(distributions: tuple[Any, ...]) -> dict[str, Array]:
    """Return where the normal heads' distributions lie, if there are any."""
    normal = [each for each in distributions if isinstance(each, NormalDistribution)]
    if not normal:
        return {}
    places = [each.location for each in normal]
    widths = [each.deviation for each in normal]
    location = places[0] if len(normal) == 1 else jnp.concatenate(places, axis=-1)
    deviation = widths[0] if len(normal) == 1 else jnp.concatenate(widths, axis=-1)
    return {
        "policy_dist_mean_std": jnp.mean(deviation),
        "policy_dist_max_std": jnp.max(deviation),
        "policy_dist_min_std": jnp.min(deviation),
        "policy_dist_mean_loc": jnp.mean(location),
        "policy_dist_max_loc": jnp.max(location),
        "policy_dist_min_loc": jnp.min(location),
    }
