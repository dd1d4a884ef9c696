"""The whole state of a training run in one pytree, which checkpoints save and resuming restores."""

from typing import Any

import jax
import jax.numpy as jnp
import optax
from flax import struct
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.training.failures import Failures
from jaxleas.training.normaliser import Normaliser
from jaxleas.types import InputError


@struct.dataclass
class TrainState:
    """The full state of a training run.

    Attributes:
        params: parameters of actor and critic.
        averaged: exponential average of the actor's parameters: what is judged and exported.
        optimiser: Adam's moments and the learning rate's step count.
        normaliser: normaliser of observations.
        episode: state of every robot's episode, as the task defines it.
        observation: observation of every robot, one vector each.
        key: randomness of everything still to come.
        update: number of policy updates done.
        failures: where episodes failed lately; None where starts ignore it (`ppo.failure_starts`).
    """

    params: Any
    averaged: Any
    optimiser: optax.OptState
    normaliser: Normaliser
    episode: Any
    observation: Float[Array, "robots size"]
    key: Key[Array, ""]
    update: Int[Array, ""]
    failures: Failures | None = None


@struct.dataclass
class Learned:
    """The learned networks of a run, from which another run can begin.

    Attributes:
        params: parameters of actor and critic.
        averaged: averaged parameters of the actor.
        normaliser: normaliser of observations.
    """

    params: Any
    averaged: Any
    normaliser: Normaliser

    @classmethod
    def of(cls, state: TrainState) -> "Learned":
        """Return what the run with this state has learned."""
        return cls(params=state.params, averaged=state.averaged, normaliser=state.normaliser)

    def into(self, state: TrainState) -> TrainState:
        """Return a fresh state with these networks in place of untrained ones.

        Raises:
            InputError: the networks are of other sizes.
        """
        mine = jax.tree.map(jnp.shape, (self.params, self.averaged, self.normaliser))
        theirs = jax.tree.map(jnp.shape, (state.params, state.averaged, state.normaliser))
        if jax.tree.structure(mine) != jax.tree.structure(theirs) or mine != theirs:
            raise InputError(
                "the networks to begin with are not of the sizes that this configuration asks for:"
                " network.hidden and env.observation must be the same"
            )
        return state.replace(  # type: ignore[attr-defined]
            params=self.params, averaged=self.averaged, normaliser=self.normaliser
        )
