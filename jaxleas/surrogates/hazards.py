"""Hazards along many labelled paths: the network's logits, and their likelihood."""

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from jaxleas.envs.steering import SteeringEnv
from jaxleas.surrogates.features import mirrored, path_features
from jaxleas.surrogates.labelled_paths import LabelledPaths
from jaxleas.surrogates.network import Weights, recur
from jaxleas.surrogates.surrogate import Identity, Surrogate
from jaxleas.surrogates.verdict_report import failure_along
from jaxleas.terrain import Atlas
from jaxleas.types import RootMotion

_CHUNK = 512  # paths per computation of hazards


class Hazards:
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


def foreseen_failure(
    surrogate: Surrogate, env: SteeringEnv, atlas: Atlas, paths: LabelledPaths
) -> np.ndarray:
    """Return the probability that the planner fails somewhere along each path.

    Args:
        surrogate: surrogate of the planner.
        env: environment that gives the surrogate its local terrain.
        atlas: terrains of the paths.
        paths: paths whose failure is foreseen; their verdicts are not looked at.
    """
    hazards = Hazards(env, surrogate.identity)
    logit = hazards.logits(surrogate.weights, atlas, paths)
    logit = float(surrogate.scale) * logit + float(surrogate.shift)
    return failure_along(logit, paths)
