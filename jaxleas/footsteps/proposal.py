"""A learned proposal: which command a planner would choose, scored in microseconds."""

import hashlib
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.proposal_inputs import ProposalInputs
from jaxleas.types import ControllerIdentity, InputError

ARRAYS = ("of_command", "of_state", "bias", "hidden", "hidden_bias", "last")


@dataclass(frozen=True, eq=False)
class Proposal:
    """A network that scores commands: the planner's choice shall have the highest score.

    first = relu(commands @ of_command + state @ of_state + bias)
    score = relu(first @ hidden + hidden_bias) @ last

    The same weights score each command, so that they serve any choice of commands.

    Attributes:
        controller: identity of the controller whose commands are scored.
        motion: digest of the motion models that its inputs are made with.
        of_command: weights of what is seen of a command.
        of_state: weights of what no command changes.
        bias: bias of the first layer.
        hidden: weights of the second layer.
        hidden_bias: bias of the second layer.
        last: weights of the score.
        provenance: how it was taught.
    """

    controller: ControllerIdentity
    motion: str
    of_command: Float[np.ndarray, "P H"]
    of_state: Float[np.ndarray, "Q H"]
    bias: Float[np.ndarray, " H"]
    hidden: Float[np.ndarray, "H K"]
    hidden_bias: Float[np.ndarray, " K"]
    last: Float[np.ndarray, " K"]
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        first, second = len(self.bias), len(self.hidden_bias)
        wanted = {
            "of_command": (len(self.of_command), first),
            "of_state": (len(self.of_state), first),
            "hidden": (first, second),
            "last": (second,),
        }
        for name, shape in wanted.items():
            found = getattr(self, name)
            if found.shape != shape or not np.isfinite(found).all():
                raise InputError(
                    f"a proposal's {name} has shape {found.shape} where finite numbers of {shape}"
                    " are needed"
                )

    def scores(self, inputs: ProposalInputs) -> Float[np.ndarray, " C"]:
        """Return the score of each command."""
        first = inputs.commands @ self.of_command + (inputs.state @ self.of_state + self.bias)
        second = np.maximum(first, 0.0) @ self.hidden + self.hidden_bias
        return np.maximum(second, 0.0) @ self.last

    def require_fits(self, model: MotionModel, where: str) -> None:
        """Refuse motion models of another controller, or others than it was taught with.

        Args:
            model: motion models of the walk.
            where: what the proposal was found in, for the message.

        Raises:
            InputError: they are others.
        """
        model.controller.require_same(self.controller, where, "the walk")
        if (found := motion_digest(model)) != self.motion:
            raise InputError(
                f"{where} was taught with other motion models of {model.controller.name}"
                f" ({self.motion[:12]}... instead of {found[:12]}...): teach it anew with"
                " jaxleas gait distill"
            )


def motion_digest(model: MotionModel) -> str:
    """Return the SHA-256 of the weights of motion models, as hexadecimal digits."""
    digest = hashlib.sha256(model.feet.encode())
    for weights in model.weights:
        digest.update(np.ascontiguousarray(weights, dtype="<f8").tobytes())
    return digest.hexdigest()
