"""What a proposal sees of each command: where it leads, and the ground that lies ahead there.

All of it is in the robot's frame after the footstep, or before it for what no command changes.
Where the right one of the swinging feet comes first, left and right are exchanged, so that one
network serves both pairs.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.features import turned, wrapped
from jaxleas.footsteps.framed_map import FramedMap
from jaxleas.footsteps.model import MOTION, MotionModel
from jaxleas.footsteps.search_states import Node
from jaxleas.footsteps.walking_state import Goal
from jaxleas.types import InputError

AHEAD = np.arange(-2, 13) * 0.05
"""Where the ground is looked at ahead of a foot [m]."""
ASIDE = np.array([-0.12, -0.06, 0.06, 0.12])
"""The same to its sides [m]."""
LOOKS = len(AHEAD) + len(ASIDE)
CLEAR, HIGH = 0.10, 0.20
"""Distance from edges [m], and rise or drop [m], beyond which all are the same."""
FAR = 1.0
"""Distance of a goal beyond which all are the same [m]."""


@dataclass(frozen=True, eq=False)
class ProposalInputs:
    """Inputs of a proposal's network in one state.

    Attributes:
        commands: what is seen of each command.
        state: what no command changes.
    """

    commands: Float[np.ndarray, "C P"]
    state: Float[np.ndarray, " Q"]


class ProposalSight:
    """Sees states as a proposal does.

    Args:
        model: motion models.
        costs: foot cost map.
        commands: commands to choose from.

    Raises:
        InputError: the pairs of the controller have different numbers of feet.
    """

    def __init__(
        self, model: MotionModel, costs: FootCostMap, commands: Float[np.ndarray, "C 3"]
    ) -> None:
        if len({len(pair) for pair in model.controller.pairs}) > 1:
            raise InputError(
                f"controller {model.controller.name} swings different numbers of feet in turn"
                f" ({', '.join(model.controller.pair_names)}): a proposal needs one number"
            )
        self._model = model
        self._commands = commands
        self._largest = np.maximum(model.controller.max_speeds, 1e-9)
        self._map = FramedMap(costs, model.controller.foot_radius)

    def of(self, node: Node, goal: Goal) -> ProposalInputs:
        """Return the inputs in a state.

        Args:
            node: state, with what was commanded until now.
            goal: pose to walk to.
        """
        swinging = list(self._model.controller.pairs[node.pair])
        standing = [foot for foot in range(len(node.feet)) if foot not in swinging]
        feet = turned(node.feet[:, :2] - node.com, np.asarray(-node.yaw))
        side = 1.0 if feet[swinging[0], 1] >= 0.0 else -1.0
        flip = np.array([1.0, side])
        turning = np.array([1.0, side, side])
        shift, turn, velocity, places = self._predicted(node, feet, swinging)
        com = node.com + turned(shift, np.full(len(shift), node.yaw))
        yaw = node.yaw + turn
        landings = com[:, None] + turned(places, yaw[:, None])
        shares = self._commands / self._largest
        before = node.command / self._largest
        earlier = node.earlier / self._largest
        lift_off = node.feet[:, 2]
        away = turned(np.array([goal.x, goal.y]) - com, -yaw)
        apart = np.hypot(away[:, 0], away[:, 1])
        left = np.minimum(1.0, FAR / np.maximum(apart, 1e-9))[:, None] * away * flip
        misses = wrapped(goal.yaw - yaw) * (goal.angle < np.pi)
        seen = [
            *(shares * turning, (shares - before) * turning),
            np.abs(shares - before).sum(axis=1),
            *((shares - 2.0 * before + earlier)[:, 0], shift * flip * TENTHS, turn * side * TENTHS),
            *(velocity[:, :2] * flip, velocity[:, 2], velocity[:, 3] * side),
            *(left, np.minimum(apart, FAR), misses * side, np.abs(misses)),
            (places * flip * TENTHS).reshape(len(com), -1),
            self._looked(landings, yaw, lift_off[swinging], side),
        ]
        level = np.full(len(standing), lift_off[swinging].mean())
        stance = self._looked(node.feet[None, standing, :2], np.array([node.yaw]), level, side)
        lies = (lift_off[standing] - level) / HIGH
        state = [
            *((feet[swinging + standing] * flip * TENTHS).ravel(), lies),
            *(node.velocity[:2] * flip, node.velocity[2:3], node.velocity[3:] * side),
            *(before * turning, earlier * turning),
            np.array([min(goal.speed, 1.0), goal.angle < np.pi, goal.distance]),
            stance[0],
        ]
        return ProposalInputs(
            np.column_stack(seen).astype(np.float32), np.concatenate(state).astype(np.float32)
        )

    def _predicted(
        self, node: Node, feet: Float[np.ndarray, "E 2"], swinging: list[int]
    ) -> tuple[np.ndarray, ...]:
        """Return displacement, turn, velocity, and landings in the robot's frame afterwards."""
        known = np.concatenate([feet.ravel(), node.command, node.velocity])
        seen = np.column_stack([self._commands, np.tile(known, (len(self._commands), 1))])
        out = self._model.predict(node.pair, seen)
        shift, turn = out[:, :2], out[:, 2]
        places = out[:, MOTION:].reshape(len(out), -1, 2)
        if self._model.feet == "absolute":
            places = turned(feet[swinging] + places - shift[:, None], -turn[:, None])
        return shift, turn, out[:, 3:MOTION], places

    def _looked(
        self,
        places: Float[np.ndarray, "K S 2"],
        yaw: Float[np.ndarray, " K"],
        level: Float[np.ndarray, " S"],
        side: float,
    ) -> Float[np.ndarray, "K L"]:
        """Return distances from edges, and heights above feet, ahead of places and aside."""
        looks = np.concatenate(
            [np.column_stack([AHEAD, 0.0 * AHEAD]), np.column_stack([0.0 * ASIDE, side * ASIDE])]
        )
        directions = turned(np.broadcast_to(looks, (len(yaw), *looks.shape)), yaw[:, None])
        distance, height = self._map.at(places[:, :, None] + directions[:, None])
        rise = np.where(np.isnan(height), -HIGH, height - level[:, None])
        rise = np.clip(rise, -HIGH, HIGH) / HIGH
        near = np.minimum(distance, CLEAR) / CLEAR
        return np.concatenate([near, rise], axis=-1).reshape(len(places), -1)


TENTHS = 10.0
"""Lengths of strides are given in tenths of a metre, and turns in tenths of a radian."""
