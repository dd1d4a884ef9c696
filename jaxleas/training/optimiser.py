"""Adam with a clipped gradient and a linearly falling learning rate (T sec. 3.4)."""

import optax

from jaxleas.training.config import PpoConfig
from jaxleas.training.ppo_params import PpoParams
from jaxleas.xla import BETA_1, BETA_2, EPSILON


def make_optimiser(config: PpoConfig, params: PpoParams) -> optax.GradientTransformation:
    """Return Adam with a clipped gradient and a linearly falling learning rate (T sec. 3.4).

    It makes the state; `adam.descend` is its update, written out, and a test compares the two.

    Args:
        config: configuration of PPO, which gives the number of gradient steps.
        params: hyperparameters: learning rates and gradient norm, constants or traced.
    """
    # On one vector: a few operations per step instead of a few per layer.
    return optax.flatten(
        optax.chain(
            optax.clip_by_global_norm(params.max_gradient_norm),
            optax.adam(learning_rate(config, params), b1=BETA_1, b2=BETA_2, eps=EPSILON),
        )
    )


def learning_rate(config: PpoConfig, params: PpoParams) -> optax.Schedule:
    """Return the falling learning rate, a function of the gradient steps done.

    Args:
        config: configuration of PPO, which gives the number of gradient steps.
        params: hyperparameters: learning rates at start and end, constants or traced.
    """
    gradient_steps = config.updates * config.epochs * config.minibatches
    return optax.linear_schedule(params.learning_rate, params.final_learning_rate, gradient_steps)
