"""The surrogate's network: one recurrent step per kept configuration gives a hazard.

A gated recurrent unit (Cho et al. 2014): its hidden state represents the stance that the contact
planner would have.
"""

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float, Key


@struct.dataclass
class Weights:
    """The weights of encoder, recurrent unit and head.

    Attributes:
        encoder: matrix from features to code.
        encoder_bias: bias of the code.
        gates: matrix from code and hidden state to the reset and update gates.
        gates_bias: bias of the gates.
        candidate: matrix from code and reset hidden state to the candidate.
        candidate_bias: bias of the candidate.
        head: matrix from hidden state to the hazard's logit.
        head_bias: bias of the hazard's logit.
    """

    encoder: Float[Array, "size code"]
    encoder_bias: Float[Array, " code"]
    gates: Float[Array, "both twice"]
    gates_bias: Float[Array, " twice"]
    candidate: Float[Array, "both hidden"]
    candidate_bias: Float[Array, " hidden"]
    head: Float[Array, " hidden"]
    head_bias: Float[Array, ""]

    @property
    def hidden_size(self) -> int:
        """Number of values that are carried from step to step."""
        return self.head.shape[0]


def initial_weights(key: Key[Array, ""], size: int, code: int, hidden: int) -> Weights:
    """Return random weights, each layer's scaled by its number of inputs.

    Args:
        key: random key, consumed here.
        size: number of features.
        code: number of outputs of the encoder.
        hidden: number of values carried from step to step.
    """
    encoder_key, gates_key, candidate_key = jax.random.split(key, 3)

    def kernel(kernel_key: Array, inputs: int, outputs: int) -> Array:
        return jax.random.normal(kernel_key, (inputs, outputs)) * (1.0 / inputs) ** 0.5

    return Weights(
        encoder=kernel(encoder_key, size, code),
        encoder_bias=jnp.zeros(code),
        gates=kernel(gates_key, code + hidden, 2 * hidden),
        gates_bias=jnp.zeros(2 * hidden),
        candidate=kernel(candidate_key, code + hidden, hidden),
        candidate_bias=jnp.zeros(hidden),
        head=jnp.zeros(hidden),
        head_bias=jnp.float32(-5.0),  # at first every stretch is predicted to pass
    )


def recur(
    weights: Weights, hidden: Float[Array, "*batch hidden"], features: Float[Array, "*batch size"]
) -> tuple[Float[Array, "*batch hidden"], Float[Array, "*batch"]]:
    """Take one step; return the hidden state after it and the logit of the hazard."""

    def across(vector: Array) -> Array:  # the batch axes, written out
        return vector.reshape((1,) * (features.ndim - 1) + vector.shape)

    code = jax.nn.relu(features @ weights.encoder + across(weights.encoder_bias))
    both = jnp.concatenate([code, hidden], axis=-1)
    gates = jax.nn.sigmoid(both @ weights.gates + across(weights.gates_bias))
    reset, update = jnp.split(gates, 2, axis=-1)
    both = jnp.concatenate([code, reset * hidden], axis=-1)
    candidate = jnp.tanh(both @ weights.candidate + across(weights.candidate_bias))
    hidden = update * hidden + (1.0 - update) * candidate
    return hidden, hidden @ weights.head + weights.head_bias
