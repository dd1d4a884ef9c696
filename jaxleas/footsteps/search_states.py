"""States of a search over footsteps, and the footsteps that lead on from them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True, eq=False)
class Node:
    """A state of the search, predicted or measured.

    Attributes:
        com: x and y of the centre of mass [m].
        yaw: heading [rad].
        velocity: velocity of the centre of mass [m/s] and turning rate [rad/s], in its frame.
        feet: positions of the feet [m].
        pair: index of the pair that swings next.
        command: command that led here.
        earlier: command before that one.
        spent: cost so far.
        depth: number of footsteps so far.
        parent: state before; None at the start.
    """

    com: Float[np.ndarray, "2"]
    yaw: float
    velocity: Float[np.ndarray, "4"]
    feet: Float[np.ndarray, "E 3"]
    pair: int
    command: Float[np.ndarray, "3"]
    earlier: Float[np.ndarray, "3"]
    spent: float = 0.0
    depth: int = 0
    parent: "Node | None" = None


@dataclass(frozen=True, eq=False)
class Children:
    """The footsteps that commands lead to from some states; their swings are not yet checked.

    Attributes:
        parents: states that they begin in, all with the same pair swinging.
        parent: index of the state that each begins in.
        command: index of its command.
        com: x and y of the centre of mass afterwards [m].
        yaw: heading [rad].
        velocity: velocity and turning rate, in the frame there.
        landings: positions of the swinging feet [m].
        near: how much nearer than `FAR_ENOUGH` the landings are to unsafe cells, in sum [m].
    """

    parents: list[Node]
    parent: Int[np.ndarray, " K"]
    command: Int[np.ndarray, " K"]
    com: Float[np.ndarray, "K 2"]
    yaw: Float[np.ndarray, " K"]
    velocity: Float[np.ndarray, "K 4"]
    landings: Float[np.ndarray, "K S 3"]
    near: Float[np.ndarray, " K"]
