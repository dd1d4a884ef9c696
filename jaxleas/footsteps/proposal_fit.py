"""Fits a proposal to the choices of a planner."""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import Array, Float, Int

from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.proposal import Proposal, motion_digest

Weights = dict[str, Float[Array, "..."]]


@dataclass(frozen=True)
class ProposalFit:
    """How a proposal is fitted.

    Attributes:
        epochs: times that each choice is learned from.
        batch: choices of one update.
        rate: largest rate of Adam.
        decay: decay of weights.
        hidden: sizes of both layers.
        seed: seed of the first weights and of the order of the choices.
    """

    epochs: int = 30
    batch: int = 256
    rate: float = 2e-3
    decay: float = 0.03
    hidden: tuple[int, int] = (96, 32)
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Choices:
    """What a planner chose, and what the proposal sees of it.

    Attributes:
        commands: what is seen of each command.
        state: what no command changes.
        chosen: index of the command that the planner chose.
    """

    commands: Float[np.ndarray, "N C P"]
    state: Float[np.ndarray, "N Q"]
    chosen: Int[np.ndarray, " N"]

    def __len__(self) -> int:
        return len(self.chosen)


def fit_proposal(
    choices: Choices,
    model: MotionModel,
    settings: ProposalFit,
    shown: Callable[[int, float], None] = lambda epoch, loss: None,
) -> Proposal:
    """Return the proposal that gives the chosen commands the highest probability.

    Args:
        choices: what the planner chose.
        model: motion models that the inputs were made with.
        settings: how it is fitted.
        shown: function called with the number and the mean loss of each epoch.
    """
    moments = [_moments(each) for each in (choices.commands, choices.state)]
    rng = np.random.default_rng(settings.seed)
    count = len(choices) // settings.batch
    if not count:  # fewer choices than a batch
        count, batch = 1, len(choices)
    else:
        batch = settings.batch
    weights = _first(choices, settings)
    schedule = optax.cosine_decay_schedule(settings.rate, settings.epochs * count)
    optimiser = optax.adamw(schedule, weight_decay=settings.decay)

    @jax.jit
    def update(weights: Weights, state: optax.OptState, batch: tuple[Array, Array, Array]):
        commands, seen, chosen = batch

        def loss(weights: Weights) -> Array:
            inputs = _levelled(commands.astype(jnp.float32), moments[0])
            scores = _scores(weights, inputs, _levelled(seen, moments[1]))
            return optax.softmax_cross_entropy_with_integer_labels(scores, chosen).mean()

        value, gradient = jax.value_and_grad(loss)(weights)
        changes, state = optimiser.update(gradient, state, weights)
        return optax.apply_updates(weights, changes), state, value

    state = optimiser.init(weights)
    for epoch in range(settings.epochs):
        order, losses = rng.permutation(len(choices))[: count * batch].reshape(count, batch), []
        for rows in order:
            batch_of = (choices.commands[rows], choices.state[rows], choices.chosen[rows])
            weights, state, value = update(weights, state, batch_of)
            losses.append(value)
        shown(epoch + 1, float(np.mean(jax.device_get(losses))))
    return _made(jax.device_get(weights), moments, model)


def agreement(proposal: Proposal, choices: Choices) -> float:
    """Return the share of choices in which a proposal has the planner's command first."""
    first = np.einsum("ncp,ph->nch", choices.commands.astype(np.float32), proposal.of_command)
    first += (choices.state @ proposal.of_state + proposal.bias)[:, None]
    second = np.maximum(np.maximum(first, 0.0) @ proposal.hidden + proposal.hidden_bias, 0.0)
    return float(np.mean((second @ proposal.last).argmax(axis=1) == choices.chosen))


def _levelled(
    values: Float[Array, "*batch K"], moments: tuple[np.ndarray, np.ndarray]
) -> Float[Array, "*batch K"]:
    """Return values of mean 0 and scale 1."""
    mean, scale = (jnp.reshape(each, (1,) * (values.ndim - 1) + each.shape) for each in moments)
    return (values - mean) / scale


def _scores(
    weights: Weights, commands: Float[Array, "N C P"], state: Float[Array, "N Q"]
) -> Float[Array, "N C"]:
    of_state = state @ weights["of_state"] + weights["bias"][None]
    first = jax.nn.relu(commands @ weights["of_command"] + of_state[:, None])
    second = jax.nn.relu(first @ weights["hidden"] + weights["hidden_bias"][None, None])
    return second @ weights["last"]


def _first(choices: Choices, settings: ProposalFit) -> Weights:
    keys = jax.random.split(jax.random.key(settings.seed), 4)
    seen, known = choices.commands.shape[2], choices.state.shape[1]
    one, two = settings.hidden

    def drawn(key: Array, *shape: int) -> Array:
        return jax.random.normal(key, shape) / jnp.sqrt(seen + known if len(shape) > 1 else two)

    return {
        "of_command": drawn(keys[0], seen, one),
        "of_state": drawn(keys[1], known, one),
        "bias": jnp.zeros(one),
        "hidden": jax.random.normal(keys[2], (one, two)) * jnp.sqrt(2.0 / one),
        "hidden_bias": jnp.zeros(two),
        "last": drawn(keys[3], two),
    }


def _moments(values: Float[np.ndarray, "*batch K"]) -> tuple[np.ndarray, np.ndarray]:
    """Return means and scales of columns; a column that never changes has a scale of 1."""
    rows = values.reshape(-1, values.shape[-1])[:: max(1, values.size // _MOST)].astype(np.float32)
    scale = rows.std(axis=0)
    return rows.mean(axis=0), np.where(scale > _STILL, scale, 1.0).astype(np.float32)


_MOST, _STILL = 50_000_000, 1e-3


def _made(weights: dict[str, np.ndarray], moments: list, model: MotionModel) -> Proposal:
    """Return a proposal that takes its inputs as they are: means and scales become weights."""
    (commands_mean, commands_scale), (state_mean, state_scale) = moments
    of_command = weights["of_command"] / commands_scale[:, None]
    of_state = weights["of_state"] / state_scale[:, None]
    bias = weights["bias"] - commands_mean @ of_command - state_mean @ of_state
    return Proposal(
        *(model.controller, motion_digest(model), of_command, of_state, bias),
        *(weights["hidden"], weights["hidden_bias"], weights["last"]),
    )
