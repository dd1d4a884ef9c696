"""The protocol of a condition: points to read, and a margin from their heights and a motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.conditions.points import Points, columns_of, union_of_points
from jaxleas.types import NO_GROUND_IN_ROOT, InputError, RootMotion

VOID_IN_ROOT = NO_GROUND_IN_ROOT
"""Height in the root frame [m] at or below which there is no ground."""

MARGIN_LIMIT = 1.0
"""Bound to which margins are clipped, +- [m]: they are finite even over the void."""

MarginFunction = Callable[[Array, RootMotion], Array]
"""A function from heights [*batch, P] and a root motion to a margin [*batch], without its points.
Such a callable is a condition of the older kind: it reads the heights at all points."""


class Condition(Protocol):
    """A condition on a configuration: an analytic one or the user's own."""

    @property
    def points_in_root(self) -> Points:
        """The points whose heights the condition reads, in this order [m]."""
        ...

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the signed margin, positive where the condition is satisfied.

        Args:
            heights_in_root: height of the terrain under each point minus the root's z [m];
                `VOID_IN_ROOT` or less where there is no ground.
            motion: root motion, which the analytic conditions ignore.

        Returns:
            Margin [m], clipped to +- `MARGIN_LIMIT`.
        """
        ...


@dataclass(frozen=True, eq=False)
class OnPoints:
    """A callable as a condition, which reads the heights at given points.

    Attributes:
        points_in_root: points in the root frame [m].
        judge: callable that takes the heights at the points.
    """

    points_in_root: Points
    judge: MarginFunction

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the margin of the callable."""
        return self.judge(heights_in_root, motion)


def stated_points(condition: Condition | MarginFunction) -> Points | None:
    """Return the points that a condition states; None for a plain callable."""
    points = getattr(condition, "points_in_root", None)
    return None if points is None else np.asarray(points, dtype=np.float64)


def with_points(condition: Condition | MarginFunction, points: Points) -> Condition:
    """Return a condition unchanged, or a plain callable as one that reads `points`."""
    if stated_points(condition) is None:
        return OnPoints(points, condition)
    return condition  # type: ignore[return-value]


def all_of(*conditions: Condition | MarginFunction, order: Points | None = None) -> Any:
    """Return the condition that holds where all of `conditions` do: the smallest of their margins.

    It reads the union of their points. A plain callable states no points: it receives all the
    heights that the others read, which must then all read the same ones.

    Args:
        conditions: conditions to combine, at least one.
        order: points in the root frame that set the order of the union, as far as it lies among
            them [m]; by default the order of the conditions.

    Returns:
        A `Condition`, or a plain callable if every condition is one.

    Raises:
        InputError: no condition is given, or plain callables are mixed with conditions that read
            different points.
    """
    if not conditions:
        raise InputError("all_of needs at least one condition")
    stated = [each for each in map(stated_points, conditions) if each is not None]
    if not stated:
        return _least(conditions)
    points = union_of_points(stated, order)
    if len(stated) < len(conditions):
        if not all(np.array_equal(each, stated[0]) for each in stated):
            raise InputError(
                "all_of is given a plain callable and conditions that read different points: give"
                " the callable points of its own, OnPoints(points_in_root, callable)"
            )
        points = stated[0]
    return AllOf(points, tuple(conditions))


class AllOf:
    """The smallest margin of several conditions, each of which reads its own points."""

    def __init__(
        self, points_in_root: Points, conditions: Sequence[Condition | MarginFunction]
    ) -> None:
        """Combine conditions.

        Args:
            points_in_root: points to read, including those of each condition [m].
            conditions: conditions to combine; a plain callable reads all of the points.
        """
        self.points_in_root = points_in_root
        self.conditions = tuple(conditions)
        self._judge = _least(
            [
                each if stated_points(each) is None else read_from(points_in_root, each)  # type: ignore[arg-type]
                for each in conditions
            ]
        )

    def __call__(
        self, heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        """Return the smallest of the margins."""
        return self._judge(heights_in_root, motion)

    def read_from(self, points: Points) -> "Condition":
        """Return the same condition for the heights at further points."""
        own = [
            OnPoints(self.points_in_root, each) if stated_points(each) is None else each  # type: ignore[arg-type]
            for each in self.conditions
        ]
        return AllOf(points, own)


def _least(judges: Sequence[MarginFunction]) -> MarginFunction:
    def judge(
        heights_in_root: Float[Array, "*batch P"], motion: RootMotion
    ) -> Float[Array, "*batch"]:
        margin = judges[0](heights_in_root, motion)
        for each in judges[1:]:
            margin = jnp.minimum(margin, each(heights_in_root, motion))
        return margin

    return judge


def read_from(points: Points, condition: Condition) -> Condition:
    """Return the same condition for the heights at further points, which include its own.

    The analytic conditions change their indices (in their method `read_from`): a gather of their
    heights would cost 20 times as much on a processor. Others receive `heights[..., columns]`.

    Args:
        points: points in the root frame whose heights the result takes [m].
        condition: condition to convert.

    Raises:
        InputError: a point that the condition reads is not among them.
    """
    if np.array_equal(points, condition.points_in_root):
        return condition
    rewritten = getattr(condition, "read_from", None)
    if rewritten is not None:
        return rewritten(points)
    columns = columns_of(condition.points_in_root, points)
    return OnPoints(points, lambda heights, motion: condition(heights[..., columns], motion))
