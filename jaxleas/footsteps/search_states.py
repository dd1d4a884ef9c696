"""States of a search over footsteps, and the footsteps that lead on from them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.features import turned
from jaxleas.footsteps.model import MOTION, MotionModel
from jaxleas.footsteps.plan import PlannedFootstep
from jaxleas.footsteps.walking_state import WalkingState


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


def start_node(state: WalkingState, costs: FootCostMap) -> Node:
    """Return a measured state as a node; feet stand on the map where it has ground."""
    ground = costs.height_map.height_at(state.feet[:, :2]).astype(np.float64)
    feet = np.column_stack(
        [state.feet[:, :2], np.where(np.isnan(ground), state.feet[:, 2], ground)]
    )
    velocity = turned(state.com_velocity, np.asarray(-state.yaw))
    return Node(
        com=state.com[:2].astype(np.float64),
        yaw=state.yaw,
        velocity=np.append(velocity, state.yaw_rate),
        feet=feet,
        pair=state.pair,
        command=state.command.astype(np.float64),
        earlier=(state.command if state.earlier is None else state.earlier).astype(np.float64),
    )


def node_after(model: MotionModel, node: Node, footstep: PlannedFootstep) -> Node:
    """Return the state after a planned footstep.

    Args:
        model: motion models, which predict the velocity.
        node: state before it.
        footstep: footstep.
    """
    feet = turned(node.feet[:, :2] - node.com, np.asarray(-node.yaw))
    seen = np.concatenate([footstep.command, feet.ravel(), node.command, node.velocity])
    return Node(
        *(footstep.com, footstep.yaw, model.predict(node.pair, seen[None])[0, 3:MOTION]),
        *(footstep.feet, (node.pair + 1) % len(model.controller.pairs)),
        *(footstep.command, node.command),
    )
