"""The turns of robots to be judged: of many robots few are due at a step, and only those cost time.

Robots are in groups, and each group serves its own robots: nothing passes between devices that
share the robots, and no group is so large that finding the robots that are due costs more than
judging them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import jax.numpy as jnp
from jax import Array
from jaxtyping import Bool

from jaxleas.conditions import Pick, everyone
from jaxleas.xla import take_along_inside

GROUP = 128
SPARE = 2.0  # room above the mean number of robots due, in standard deviations of that number


@dataclass(frozen=True)
class Turn:
    """The robots that are judged at a step.

    Attributes:
        pick: function that takes them out of an array with one entry per robot.
        give_back: function that turns an array with one entry per picked robot into one with one
            entry per robot, which has no meaning for robots that are not served.
        served: whether each robot is judged.
    """

    pick: Pick
    give_back: Callable[[Array], Array]
    served: Bool[Array, "*batch"]


def all_at_once(due: Bool[Array, "*batch"]) -> Turn:
    """Return the turn that picks all robots, and serves those that are due."""
    return Turn(everyone, everyone, due)


def in_turn(due: Bool[Array, "*batch"], every: int) -> Turn:
    """Return a turn with room for a little more than the average number of robots due.

    Args:
        due: whether each robot waits for its turn.
        every: number of steps from one turn of a robot to its next.
    """
    count = due.shape[0] if due.ndim == 1 else 0
    room = math.ceil(GROUP / every + SPARE * math.sqrt(GROUP / every * (1.0 - 1.0 / every)))
    if count == 0 or count % GROUP or room >= GROUP:
        return all_at_once(due)

    def grouped(leaf: Array) -> Array:
        return leaf.reshape(count // GROUP, GROUP, *leaf.shape[1:])

    def across(index: Array, leaf: Array) -> Array:
        return index.reshape(index.shape + (1,) * (leaf.ndim - 2))

    place = jnp.cumsum(grouped(due).astype(jnp.int32), axis=1)  # 1 for the first robot that is due
    # The robot in each place: its index is the number of robots with a smaller place.
    wanted = jnp.arange(1, room + 1)[None, :, None]
    robot = jnp.sum((place[:, None] < wanted).astype(jnp.int32), axis=2)
    robot = jnp.minimum(robot, GROUP - 1)  # any robot in an empty place; its result is not used
    seat = jnp.clip(place - 1, 0, room - 1)

    def pick(leaf: Array) -> Array:
        leaf = grouped(leaf)
        chosen = take_along_inside(leaf, across(robot, leaf), axis=1)
        return chosen.reshape(-1, *leaf.shape[2:])

    def give_back(leaf: Array) -> Array:
        leaf = leaf.reshape(count // GROUP, room, *leaf.shape[1:])
        given = take_along_inside(leaf, across(seat, leaf), axis=1)
        return given.reshape(count, *leaf.shape[2:])

    served = due & (place.reshape(count) <= room)
    return Turn(pick, give_back, served)
