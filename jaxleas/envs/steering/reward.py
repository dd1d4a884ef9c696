"""The reward (T sec. 3.2.4)."""

from collections.abc import Mapping
from typing import Any

import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering.config import RewardWeights, SteeringConfig
from jaxleas.geometry import squared_length
from jaxleas.types import RootMotion
from jaxleas.xla import sine_cosine


@struct.dataclass
class RewardParams:
    """The reward's numbers as a pytree, so that a population can train under different ones."""

    direction: Float[Array, ""]
    orientation: Float[Array, ""]
    turn: Float[Array, ""]
    acceleration: Float[Array, ""]
    alive: Float[Array, ""]
    failure: Float[Array, ""]

    @classmethod
    def of(cls, weights: RewardWeights) -> "RewardParams":
        """Return the weights of a configuration as float32 scalars."""
        return cls(**{name: jnp.float32(getattr(weights, name)) for name in cls.__annotations__})

    @classmethod
    def at(cls, numbers: Mapping[str, Any], progress: Any) -> "RewardParams":
        """Return the weights at some time during training: that of a failure grows linearly.

        Args:
            numbers: fields of `RewardWeights` by name, as reward.NAME.
            progress: completed share of the training, 0 to 1.
        """
        weights = {name: numbers[f"reward.{name}"] for name in cls.__annotations__}
        growth = numbers["reward.final_failure"] - weights["failure"]
        return cls(**(weights | {"failure": weights["failure"] + progress * growth}))


def reward(
    params: RewardParams,
    config: SteeringConfig,
    motion: RootMotion,
    command: Float[Array, "*batch 4"],
    toward_goal: Float[Array, "*batch 2"],
    valid: Float[Array, "*batch"],
) -> Float[Array, "*batch"]:
    """Return the reward of arriving at `motion` by `command`.

    R = w_dir R_dir + w_ori R_ori + w_omega R_omega + w_acc R_acc + w_alive R_alive, with
    R_dir = -(|v - v*| / (2 v_max))^2, R_ori = -(1 - q_ori . u), R_omega = -(omega / omega_max)^2,
    R_acc = -(|a| / a_max)^2 and R_alive = 1 for a valid configuration; an invalid one costs
    w_failure, which the thesis does not have.

    Args:
        params: weights of the terms.
        config: configuration of the task: bounds and desired speed.
        motion: motion of the root after the step.
        command: acceleration [m/s^2] and turn rate [rad/s].
        toward_goal: horizontal unit vector to the goal.
        valid: number that is 1 where the configuration satisfies the conditions, else 0.
    """
    limits = config.limits
    desired = config.desired_speed * toward_goal
    error = motion.velocity - jnp.stack(
        [desired[..., 0], desired[..., 1], jnp.zeros_like(valid)], axis=-1
    )
    direction = -squared_length(error) / (2.0 * limits.max_speed) ** 2
    sine, cosine = sine_cosine(motion.yaw)
    heading = cosine * toward_goal[..., 0] + sine * toward_goal[..., 1]
    turn = -jnp.square(command[..., 3] / limits.max_turn_rate)
    square = squared_length(command[..., :3])
    return (
        params.direction * direction
        + params.orientation * (heading - 1.0)
        + params.turn * turn
        - params.acceleration * square / limits.max_acceleration**2
        + params.alive * valid
        - params.failure * (1.0 - valid)
    )
