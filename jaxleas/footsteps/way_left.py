"""How many footsteps a goal is away: at least, and about."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.features import VELOCITY, turned, wrapped
from jaxleas.footsteps.model import MOTION, MotionModel
from jaxleas.footsteps.walking_state import Goal

STEADY = 12
"""Footsteps under one command after which each is like the one before."""


@dataclass(frozen=True)
class Strides:
    """How far one footstep leads at the largest commands, by the motion models.

    Attributes:
        ahead: forward [m].
        aside: to the left or to the right, whichever is less [m].
        turn: change of the heading, the lesser of both ways [rad].
        back: backward; next to nothing without such commands [m].
    """

    ahead: float
    aside: float
    turn: float
    back: float

    @classmethod
    def of(cls, model: MotionModel, commands: Float[np.ndarray, "C 3"]) -> Self:
        """Return the strides under the fastest of some commands."""
        steady = np.array([_steady(model, command) for command in commands])

        def least(axis: int, signs: tuple[int, ...]) -> float:
            """Return the lesser of the largest strides along an axis, over directions."""
            found = [
                float((sign * steady[:, axis])[sign * commands[:, axis] > 0.0].max(initial=0.0))
                for sign in signs
            ]
            return max(min(found), _NEVER)

        return cls(least(0, (1,)), least(1, (1, -1)), least(2, (1, -1)), least(0, (-1,)))


_NEVER = 1e-3
"""Stride of a movement that no command asks for: a way that needs it is long [m, rad]."""


def _steady(model: MotionModel, command: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """Return the displacement in a footstep (x, y, yaw) when one command holds: the mean of two."""
    feet = np.zeros((len(model.controller.feet), 2))
    before, velocity, moved = np.zeros(3), np.zeros(len(VELOCITY)), []
    for step in range(STEADY):
        pair = step % len(model.controller.pairs)
        seen = np.concatenate([command, feet.ravel(), before, velocity])
        out = model.predict(pair, seen[None])[0]
        landings = out[MOTION:].reshape(-1, 2)
        after = turned(feet - out[:2], np.asarray(-out[2]))
        swinging = list(model.controller.pairs[pair])
        if model.feet == "relative":
            after[swinging] = landings
        else:
            after[swinging] = turned(feet[swinging] + landings - out[:2], np.asarray(-out[2]))
        feet, before, velocity = after, command, out[3:MOTION]
        moved.append(out[:3])
    return np.asarray(np.mean(moved[-len(model.controller.pairs) :], axis=0))


class WayLeft:
    """Footsteps that are left to a goal.

    Args:
        model: motion models.
        strides: how far one footstep leads.
        goal: pose to reach.
    """

    def __init__(self, model: MotionModel, strides: Strides, goal: Goal) -> None:
        self._model, self._strides, self._goal = model, strides, goal

    def at_least(
        self, com: Float[np.ndarray, "K 2"], yaw: Float[np.ndarray, " K"]
    ) -> Float[np.ndarray, " K"]:
        """Return a bound: no stride is longer, and no turn larger, than those in the data."""
        goal = self._goal
        apart = np.hypot(com[:, 0] - goal.x, com[:, 1] - goal.y) - goal.distance
        turn = np.abs(wrapped(goal.yaw - yaw)) - goal.angle
        strides = apart / self._model.longest_stride
        turns = turn / self._model.largest_turn if self._model.largest_turn > 0 else 0.0 * turn
        return np.maximum(np.maximum(strides, turns), 0.0)

    def about(
        self, com: Float[np.ndarray, "K 2"], yaw: Float[np.ndarray, " K"]
    ) -> Float[np.ndarray, " K"]:
        """Return the footsteps of the shorter of two ways, one movement at a time.

        The robot goes ahead or back, aside and turns; or it turns to the goal, goes there, and
        turns to the heading that is wanted. What counts as there is taken off; the result is at
        least the bound.
        """
        goal, strides = self._goal, self._strides
        away = turned(np.array([goal.x, goal.y]) - com, -yaw)
        apart = np.hypot(away[:, 0], away[:, 1])
        away = away * np.maximum(1.0 - goal.distance / np.maximum(apart, 1e-9), 0.0)[:, None]
        turn = np.maximum(np.abs(wrapped(goal.yaw - yaw)) - goal.angle, 0.0)
        ahead = np.where(away[:, 0] >= 0.0, away[:, 0] / strides.ahead, -away[:, 0] / strides.back)
        as_it_stands = ahead + np.abs(away[:, 1]) / strides.aside + turn / strides.turn
        bearing = np.arctan2(away[:, 1], away[:, 0])
        back = np.maximum(np.abs(wrapped(goal.yaw - yaw - bearing)) - goal.angle, 0.0)
        length = np.maximum(apart - goal.distance, 0.0)
        turned_there = (np.abs(bearing) + back) / strides.turn + length / strides.ahead
        shorter = np.minimum(as_it_stands, np.where(length > 0.0, turned_there, np.inf))
        return np.maximum(shorter, self.at_least(com, yaw))
