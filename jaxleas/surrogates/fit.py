"""Fit a surrogate to labelled paths: maximum likelihood, calibrated and judged on other terrain."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jax import Array

from jaxleas.envs.steering import SteeringEnv
from jaxleas.surrogates.calibration import platt
from jaxleas.surrogates.features import mirrored, path_features
from jaxleas.surrogates.labelled_paths import LabelledPaths
from jaxleas.surrogates.network import Weights, initial_weights, recur
from jaxleas.surrogates.settings import FitSettings
from jaxleas.surrogates.surrogate import Identity, Surrogate
from jaxleas.surrogates.verdict_report import failure_along, report_on
from jaxleas.terrain import Atlas
from jaxleas.types import InputError, RootMotion

LEAST_FAILURES = 20  # on the terrains used for learning
LEAST_TERRAINS = 4
_CHUNK = 512  # paths per computation of hazards


@dataclass(frozen=True)
class Split:
    """Walks for learning, calibration and judgement, each on their own terrains."""

    learned: LabelledPaths
    calibration: LabelledPaths
    judged: LabelledPaths


def split_by_terrain(paths: LabelledPaths, share: float, seed: int) -> Split:
    """Split paths by terrain: no terrain of learning is in calibration or judgement.

    Raises:
        InputError: there are too few terrains, or too few verdicts of one class.
    """
    maps = np.unique(paths.map_index)
    if len(maps) < LEAST_TERRAINS:
        raise InputError(
            f"the labels come from {len(maps)} terrains; to learn on some and to judge on others"
            f" it takes {LEAST_TERRAINS} or more"
        )
    shuffled = np.random.default_rng(seed).permutation(maps)
    held = max(2, round(share * len(maps)))
    parts = shuffled[held:], shuffled[: held // 2], shuffled[held // 2 : held]
    split = Split(*(paths[np.isin(paths.map_index, part)] for part in parts))
    for name, part, least in (
        ("to learn from", split.learned, LEAST_FAILURES),
        ("to calibrate by", split.calibration, 2),
        ("to judge by", split.judged, 2),
    ):
        failures, passes = int(np.sum(part.failed_at >= 0)), int(np.sum(part.failed_at < 0))
        if min(failures, passes) < least:
            raise InputError(
                f"of the guide paths {name} the planner failed {failures} and passed {passes};"
                f" a surrogate needs {least} of each: label more of them"
            )
    return split


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
    hazards = _Hazards(env, identity)
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


def foreseen_failure(
    surrogate: Surrogate, env: SteeringEnv, atlas: Atlas, paths: LabelledPaths
) -> np.ndarray:
    """Return the probability that the planner fails somewhere along each path."""
    hazards = _Hazards(env, surrogate.identity)
    logit = hazards.logits(surrogate.weights, atlas, paths)
    logit = float(surrogate.scale) * logit + float(surrogate.shift)
    return failure_along(logit, paths)


class _Hazards:
    """The network's logits of the hazard at every kept configuration of paths."""

    def __init__(self, env: SteeringEnv, identity: Identity):
        self.identity = identity
        self.points = env.points_in_root[identity.near]
        self.mirror = mirrored(self.points)
        self._jitted = jax.jit(self._logits)

    def logits(self, weights: Weights, atlas: Atlas, paths: LabelledPaths) -> np.ndarray:
        """Return logits `[N, K]`, a chunk of paths at a time."""
        parts = []
        for first in range(0, len(paths), _CHUNK):
            rows = np.minimum(np.arange(first, first + _CHUNK), len(paths) - 1)
            parts.append(np.asarray(self._jitted(weights, atlas, arrays_of(paths[rows]))))
        return np.concatenate(parts)[: len(paths)].astype(np.float64)

    def mean_loss(self, weights: Weights, atlas: Atlas, paths: LabelledPaths) -> float:
        """Return the negative log-likelihood per known kept configuration [nats]."""
        logit, known = self.logits(weights, atlas, paths), paths.is_known
        return float(np.mean((np.logaddexp(0.0, logit) - paths.failed * logit)[known]))

    def loss(self, weights: Weights, atlas: Atlas, paths: dict[str, Array]) -> Array:
        """Return the same inside a gradient step."""
        logit = self._logits(weights, atlas, paths)
        each = jnp.logaddexp(0.0, logit) - paths["failed"] * logit
        return jnp.sum(each * paths["is_known"]) / jnp.sum(paths["is_known"])

    def _logits(self, weights: Weights, atlas: Atlas, paths: dict[str, Array]) -> Array:
        motion = RootMotion(paths["position"], paths["velocity"], paths["yaw"])
        map_index = jnp.broadcast_to(paths["map_index"][:, None], motion.yaw.shape)
        last = jax.tree.map(lambda leaf: jnp.concatenate([leaf[:, :1], leaf[:, :-1]], 1), motion)
        features = path_features(
            atlas.heights_around(map_index, motion.position, motion.yaw, self.points),
            motion,
            last,
            self.identity.keep_every,
            (self.identity.height_low, self.identity.height_high),
            self.identity.pace,
        )
        if "flip" in paths:
            order, sign = self.mirror
            image = features[..., order] * jnp.asarray(sign, features.dtype)[None, None]
            features = jnp.where(paths["flip"][:, None, None], image, features)
        hidden = jnp.zeros((len(map_index), weights.hidden_size))
        _, logit = jax.lax.scan(
            lambda carry, now: recur(weights, carry, now), hidden, jnp.swapaxes(features, 0, 1)
        )
        return logit.T


def arrays_of(paths: LabelledPaths) -> dict[str, Array]:
    """Return the network's inputs of paths as device arrays."""
    names = ("position", "yaw", "velocity", "map_index", "is_known", "failed")
    return {name: jnp.asarray(getattr(paths, name)) for name in names}


def _minibatches(generator: np.random.Generator, count: int, size: int) -> Iterator[np.ndarray]:
    """Yield rows in random order; the last minibatch is filled up from the first."""
    order = generator.permutation(count)
    for first in range(0, count, size):
        yield np.take(order, np.arange(first, first + size), mode="wrap")
