"""Fit a surrogate to labelled paths: maximum likelihood, calibrated and judged on other terrain."""

from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from jaxleas.envs.steering import SteeringEnv
from jaxleas.surrogates.calibration import platt
from jaxleas.surrogates.hazards import Hazards, arrays_of
from jaxleas.surrogates.labelled_paths import LabelledPaths
from jaxleas.surrogates.network import Weights, initial_weights
from jaxleas.surrogates.settings import FitSettings
from jaxleas.surrogates.splitting import split_by_terrain
from jaxleas.surrogates.surrogate import Identity, Surrogate
from jaxleas.surrogates.verdict_report import report_on
from jaxleas.terrain import Atlas


def fit(
    paths: LabelledPaths,
    atlas: Atlas,
    env: SteeringEnv,
    identity: Identity,
    settings: FitSettings = FitSettings(),  # noqa: B008 (frozen)
    progress: Callable[[int, float], None] = lambda epoch, loss: None,
) -> Surrogate:
    """Fit a surrogate to labelled paths.

    Each kept configuration that the planner reached counts as passed, the one where it failed as
    failed, and those after it not at all: the likelihood of a path with a hazard (discrete survival
    analysis). Failures are rare, but are not weighted: that would distort the probabilities.

    Args:
        paths: labelled paths.
        atlas: terrains of the paths.
        env: environment that gives the surrogate its local terrain.
        identity: planner, robot and observation that the surrogate is for.
        settings: settings of the fit.
        progress: function called after each epoch with the epoch and its loss.

    Raises:
        InputError: there are too few terrains, or too few verdicts of one class.
    """
    split = split_by_terrain(paths, settings.held_out, settings.seed)
    hazards = Hazards(env, identity)
    key, order_key = jax.random.split(jax.random.key(settings.seed))
    weights = initial_weights(key, identity.inputs, settings.code, settings.hidden)
    steps = settings.epochs * -(-len(split.learned) // settings.minibatch)
    rate = optax.cosine_decay_schedule(settings.learning_rate, steps)
    optimiser = optax.chain(
        optax.clip_by_global_norm(1.0), optax.adamw(rate, weight_decay=settings.weight_decay)
    )
    moments = optimiser.init(weights)  # type: ignore[arg-type]

    @jax.jit
    def improve(weights: Weights, moments: Any, paths: dict[str, Array]):
        loss, gradient = jax.value_and_grad(hazards.loss)(weights, atlas, paths)
        updates, moments = optimiser.update(gradient, moments, weights)  # type: ignore[arg-type]
        return optax.apply_updates(weights, updates), moments, loss  # type: ignore[arg-type]

    generator = np.random.default_rng(jax.random.bits(order_key, dtype=jnp.uint32).item())
    best, best_loss = weights, np.inf
    for epoch in range(settings.epochs):
        for rows in _minibatches(generator, len(split.learned), settings.minibatch):
            walked = arrays_of(split.learned[rows])
            flip = generator.random(len(rows)) < 0.5 * settings.mirror
            weights, moments, _ = improve(weights, moments, walked | {"flip": jnp.asarray(flip)})
        held_loss = hazards.mean_loss(weights, atlas, split.calibration)
        if held_loss < best_loss:
            best, best_loss = weights, held_loss
        progress(epoch + 1, held_loss)
    logit = hazards.logits(best, atlas, split.calibration)
    known = split.calibration.is_known
    scale, shift = platt(logit[known], split.calibration.failed[known])
    surrogate = Surrogate(best, jnp.float32(scale), jnp.float32(shift), identity)
    report = report_on(
        (scale * logit + shift, split.calibration),
        (scale * hazards.logits(best, atlas, split.judged) + shift, split.judged),
        learned=split.learned,
    )
    return surrogate.replace(report=report)  # type: ignore[attr-defined]


def _minibatches(generator: np.random.Generator, count: int, size: int) -> Iterator[np.ndarray]:
    """Yield rows in random order; the last minibatch is filled up from the first."""
    order = generator.permutation(count)
    for first in range(0, count, size):
        yield np.take(order, np.arange(first, first + size), mode="wrap")
