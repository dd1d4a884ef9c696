"""The loss of proximal policy optimisation, as Brax computes it, arranged for speed.

`tests/training/test_loss.py` holds values and gradients to Brax's `compute_ppo_loss`. What is
arranged otherwise: observations come normalised, once for both networks; the tanh's Jacobian, the
same under the old and the new policy, is left out of their ratio.
"""

import math
from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering.layout import ACTION_SIZE
from jaxleas.training.averages import ONE_DEVICE, Average
from jaxleas.training.config import NetworkConfig
from jaxleas.training.networks import dense

LOG_ROOT_TWO_PI = 0.5 * math.log(2.0 * math.pi)
MIN_DEVIATION = 1e-3  # of the action distribution, as Brax has it


@struct.dataclass
class Experience:
    """What was walked, or a minibatch of it.

    Attributes:
        observation: before each step [physical units].
        raw_action: before its tanh.
        location: of the normal distribution it was drawn from.
        deviation: of that distribution.
        reward: for the step.
        terminated: 1 where the episode failed with this step, else 0.
        truncated: 1 where it was cut, else 0.
    """

    observation: Float[Array, "time robots size"]
    raw_action: Float[Array, "time robots 4"]
    location: Float[Array, "time robots 4"]
    deviation: Float[Array, "time robots 4"]
    reward: Float[Array, "time robots"]
    terminated: Float[Array, "time robots"]
    truncated: Float[Array, "time robots"]


@jax.custom_vjp
def halves(logits: Float[Array, "*batch 8"]) -> tuple[Array, Array]:
    """Return the first and the second half of what the actor answers."""
    return logits[..., :ACTION_SIZE], logits[..., ACTION_SIZE:]


# Their gradients are joined. JAX pads and adds them, and XLA computes both all over, padding too.
halves.defvjp(
    lambda logits: (halves(logits), None),
    lambda _, gradients: (jnp.concatenate(gradients, axis=-1),),
)


def action_distribution(
    logits: Float[Array, "*batch 8"],
) -> tuple[Float[Array, "*batch 4"], Float[Array, "*batch 4"]]:
    """Return location and deviation of the raw action's normal distribution."""
    location, spread = halves(logits)
    return location, jax.nn.softplus(spread) + MIN_DEVIATION


def log_density(
    raw_action: Float[Array, "*batch 4"],
    location: Float[Array, "*batch 4"],
    deviation: Float[Array, "*batch 4"],
) -> Float[Array, "*batch"]:
    """Return the log density of a raw action, before its tanh."""
    distance = (raw_action - location) / deviation
    return jnp.sum(-0.5 * distance * distance - jnp.log(deviation) - LOG_ROOT_TWO_PI, axis=-1)


def tanh_log_slope(raw: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Return log(d tanh(x) / dx)."""
    return 2.0 * (math.log(2.0) - raw - jax.nn.softplus(-2.0 * raw))


def advantages(
    values: Float[Array, "time robots"],
    last_value: Float[Array, " robots"],
    reward: Float[Array, "time robots"],
    terminated: Float[Array, "time robots"],
    truncated: Float[Array, "time robots"],
    discount: Any,
    gae_lambda: Any,
) -> tuple[Float[Array, "time robots"], Float[Array, "time robots"]]:
    """Return targets of the critic and generalised advantages (Schulman et al. 2016).

    Args:
        values: of the observations.
        last_value: of the observation after the last step.
        reward: scaled.
        terminated: 1 where nothing follows.
        truncated: 1 where what follows was not seen: such steps teach nothing.
        discount: gamma.
        gae_lambda: lambda.
    """
    seen = 1.0 - truncated
    future = discount * (1.0 - terminated)
    following = jnp.concatenate([values[1:], last_value[None]])
    delta = seen * (reward + future * following - values)
    decay = gae_lambda * seen * future

    def join(later: tuple[Array, Array], earlier: tuple[Array, Array]) -> tuple[Array, Array]:
        return earlier[0] * later[0], earlier[1] + earlier[0] * later[1]

    # error = delta + decay * next error, for all times in log(time) passes: one after the other
    # they would be a launch each on a GPU, whose minibatches are done in the time of a few.
    _, errors = jax.lax.associative_scan(join, (decay, delta), reverse=True)
    targets = errors + values
    following = jnp.concatenate([targets[1:], last_value[None]])
    return targets, seen * (reward + future * following - values)


def ppo_loss(
    params: Any,
    batch: Experience,
    last_observation: Float[Array, "robots size"],
    noise: Float[Array, "time robots 4"],
    hyper: Any,
    network: NetworkConfig,
    always: Array | None = None,
    average: Average = ONE_DEVICE,
) -> tuple[Array, dict[str, Array]]:
    """Return the loss and its metrics.

    Args:
        params: of actor and critic.
        batch: with normalised observations.
        last_observation: after the last step, to bootstrap from; normalised.
        noise: standard normal, to sample the entropy with.
        hyper: with discount, gae_lambda, clip, entropy, value_weight and reward_scale.
        network: of actor and critic.
        always: true, and not known to the compiler (`networks.dense`).
        average: over the devices that have robots of this minibatch.
    """
    location, deviation = action_distribution(
        dense(params.policy, batch.observation, network, always)
    )
    values = dense(params.value, batch.observation, network, always)[..., 0]
    last_value = dense(jax.lax.stop_gradient(params.value), last_observation, network)
    targets, advantage = advantages(
        jax.lax.stop_gradient(values),
        last_value[..., 0],
        batch.reward * hyper.reward_scale,
        batch.terminated,
        batch.truncated,
        hyper.discount,
        hyper.gae_lambda,
    )
    advantage = average.standardised(advantage)
    before = log_density(batch.raw_action, batch.location, batch.deviation)
    ratio = jnp.exp(log_density(batch.raw_action, location, deviation) - before)
    clipped = jnp.clip(ratio, 1.0 - hyper.clip, 1.0 + hyper.clip)
    policy_loss = -jnp.mean(jnp.minimum(ratio * advantage, clipped * advantage))
    value_loss = 0.5 * hyper.value_weight * jnp.mean(jnp.square(targets - values))
    sample = location + deviation * noise
    entropy = 0.5 + LOG_ROOT_TWO_PI + jnp.log(deviation) + tanh_log_slope(sample)
    entropy_loss = -hyper.entropy * jnp.mean(jnp.sum(entropy, axis=-1))
    total = policy_loss + value_loss + entropy_loss
    moved = jnp.square(batch.location - location) + jnp.square(batch.deviation)
    divergence = jnp.log(deviation / batch.deviation) + moved / (2.0 * jnp.square(deviation)) - 0.5
    return total, {
        "total_loss": total,
        "policy_loss": policy_loss,
        "v_loss": value_loss,
        "entropy_loss": entropy_loss,
        "kl_mean": jnp.mean(jnp.sum(divergence, axis=-1)),
        "policy_dist_mean_std": jnp.mean(deviation),
        "policy_dist_max_std": jnp.max(deviation),
        "policy_dist_min_std": jnp.min(deviation),
        "policy_dist_mean_loc": jnp.mean(location),
        "policy_dist_max_loc": jnp.max(location),
        "policy_dist_min_loc": jnp.min(location),
    }
