"""The hyperparameters of PPO as a pytree: what members of a population may differ in."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array

from jaxleas.envs.steering.reward import RewardParams
from jaxleas.training.config import RunConfig

# Fields of `ppo` that are numbers in the compiled program and change no shape in it.
SWEPT_PPO_FIELDS = (
    *("learning_rate", "final_learning_rate", "discount", "gae_lambda", "clip", "entropy"),
    *("value_weight", "reward_scale", "max_gradient_norm"),
)
SWEPT_FIELDS = (
    *(f"ppo.{name}" for name in (*SWEPT_PPO_FIELDS, "final_failure")),
    *(f"env.reward.{name}" for name in RewardParams.__dataclass_fields__),
)
"""Dotted names of the run configuration's fields that `PpoParams` holds."""


@struct.dataclass
class PpoParams:
    """The numbers of a run's learning that vectorise: scalars, or arrays with a member axis.

    Attributes:
        learning_rate: of Adam at the start; it falls linearly.
        final_learning_rate: at the end.
        discount: gamma.
        gae_lambda: smoothing of the advantages.
        clip: of the probability ratio.
        entropy: weight of the entropy bonus.
        value_weight: weight of the critic's loss.
        reward_scale: rewards are multiplied by it before learning.
        max_gradient_norm: longer gradients are shortened to it.
        failure_growth: what an invalid configuration costs more at the end than at the start.
        reward: the reward's weights at the start.
    """

    learning_rate: Any
    final_learning_rate: Any
    discount: Any
    gae_lambda: Any
    clip: Any
    entropy: Any
    value_weight: Any
    reward_scale: Any
    max_gradient_norm: Any
    failure_growth: Any
    reward: RewardParams

    @classmethod
    def of(cls, config: RunConfig) -> "PpoParams":
        """Return a configuration's numbers: constants of the program that uses them."""
        return cls(
            **{name: getattr(config.ppo, name) for name in SWEPT_PPO_FIELDS},
            failure_growth=config.ppo.final_failure - config.env.reward.failure,
            reward=RewardParams.of(config.env.reward),
        )

    def reward_weights(self, progress: Array) -> RewardParams:
        """Return the reward's weights, of which a failure's grows linearly with the training.

        Args:
            progress: share of the updates that is done.
        """
        failure = self.reward.failure + progress * self.failure_growth
        return self.reward.replace(failure=failure)  # type: ignore[attr-defined]

    @classmethod
    def stack(cls, configs: list[RunConfig]) -> "PpoParams":
        """Return the numbers of several configurations as float32 arrays [members]."""
        each = [cls.of(config) for config in configs]
        return jax.tree.map(lambda *values: jnp.asarray(values, jnp.float32), *each)
