"""The hyperparameters of PPO as a pytree: members of a population may differ in them."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array

from jaxleas.configuration import value_of
from jaxleas.envs import TaskConfig
from jaxleas.training.config import RunConfig

# Fields of `ppo` that are numbers in the compiled program and change no shape in it.
SWEPT_PPO_FIELDS = (
    *("learning_rate", "final_learning_rate", "discount", "gae_lambda", "clip", "entropy"),
    *("value_weight", "reward_scale", "max_gradient_norm"),
)


def swept_fields(task: TaskConfig) -> tuple[str, ...]:
    """Return the dotted names of a run configuration's fields that `PpoParams` holds."""
    return (
        *(f"ppo.{name}" for name in SWEPT_PPO_FIELDS),
        *(f"env.{name}" for name in task.swept),
    )


def task_numbers(task: TaskConfig) -> dict[str, Array]:
    """Return the values of a task's `swept` fields by their dotted names, float32."""
    return {name: jnp.float32(value_of(task, name)) for name in task.swept}


@struct.dataclass
class PpoParams:
    """The numbers of a run's learning that vectorise: scalars, or arrays with a member axis.

    Attributes:
        learning_rate: learning rate of Adam at the start; it falls linearly.
        final_learning_rate: learning rate at the end.
        discount: gamma.
        gae_lambda: smoothing factor of the advantages.
        clip: bound on the change of the probability ratio.
        entropy: weight of the entropy bonus.
        value_weight: weight of the critic's loss.
        reward_scale: factor by which rewards are multiplied before learning.
        max_gradient_norm: norm to which longer gradients are shortened.
        task: hyperparameters of the task, by the dotted names of its `swept` fields.
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
    task: dict[str, Any]

    @classmethod
    def of(cls, config: RunConfig) -> "PpoParams":
        """Return a configuration's numbers: constants of the program that uses them."""
        return cls(
            **{name: getattr(config.ppo, name) for name in SWEPT_PPO_FIELDS},
            task=task_numbers(config.env),
        )

    @classmethod
    def stack(cls, configs: list[RunConfig]) -> "PpoParams":
        """Return the numbers of several configurations as float32 arrays [members]."""
        each = [cls.of(config) for config in configs]
        return jax.tree.map(lambda *values: jnp.asarray(values, jnp.float32), *each)
