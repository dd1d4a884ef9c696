"""Where all commands lead from many states, by one multiplication of matrices."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.features import turned
from jaxleas.footsteps.model import MOTION, MotionModel
from jaxleas.footsteps.search_states import Node


@dataclass(frozen=True, eq=False)
class Predicted:
    """Footsteps as motion models predict them: all commands of the first state, then the next.

    Attributes:
        com: x and y of the centre of mass afterwards [m].
        yaw: heading [rad].
        velocity: velocity [m/s] and turning rate [rad/s], in the frame there.
        places: x and y of the swinging feet [m].
        is_known: whether neither stride nor turn is larger than any in the data.
    """

    com: Float[np.ndarray, "K 2"]
    yaw: Float[np.ndarray, " K"]
    velocity: Float[np.ndarray, "K 4"]
    places: Float[np.ndarray, "K S 2"]
    is_known: Bool[np.ndarray, " K"]


class Prediction:
    """Motion models asked for the same commands in state after state.

    Args:
        model: motion models.
        commands: commands that they are asked for.
    """

    def __init__(self, model: MotionModel, commands: Float[np.ndarray, "C 3"]) -> None:
        self._model, self._count = model, len(commands)
        # The command's share of a prediction is the same in every state.
        self._of_command = [commands @ weights[:3] for weights in model.weights]
        self._of_state = [weights[3:] for weights in model.weights]

    def of(self, parents: list[Node]) -> Predicted:
        """Return the footsteps of all commands from states with one pair swinging."""
        pair, count = parents[0].pair, self._count
        swinging = list(self._model.controller.pairs[pair])
        com = np.stack([node.com for node in parents])
        yaw = np.array([node.yaw for node in parents])
        feet = np.stack([node.feet for node in parents])[:, :, :2]
        state = np.column_stack(
            [
                turned(feet - com[:, None], -yaw[:, None]).reshape(len(parents), -1),
                np.stack([node.command for node in parents]),
                np.stack([node.velocity for node in parents]),
                np.ones(len(parents)),
            ]
        )
        outputs = self._of_command[pair] + (state @ self._of_state[pair])[:, None]
        outputs = outputs.reshape(len(parents) * count, -1)
        before = np.repeat(yaw, count)
        shift, turn = outputs[:, :2], outputs[:, 2]
        is_known = (shift**2).sum(axis=1) <= self._model.longest_stride**2
        is_known &= np.abs(turn) <= self._model.largest_turn
        after = np.repeat(com, count, axis=0) + turned(shift, before)
        moved = outputs[:, MOTION:].reshape(len(outputs), -1, 2)
        if self._model.feet == "absolute":
            base = np.repeat(feet[:, swinging], count, axis=0)
            places = base + turned(moved, before[:, None])
        else:
            places = after[:, None] + turned(moved, (before + turn)[:, None])
        return Predicted(after, before + turn, outputs[:, 3:MOTION], places, is_known)
