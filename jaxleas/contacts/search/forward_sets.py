"""Exact forward sets: where the foot that stands may be after each step.

A step constrains the landing foot m from the standing one o alone, p_m - p_o in D, and the next
step knows of the feet only where the one stands that does not move then: the anchor. So a state is
the number of steps made and a convex set of places of the anchor. Where feet alternate, m is the
next anchor, and its set is (F + D) on the surface. Where m moves once more, o remains the anchor,
and of its set those places are kept from which m could land: F with (surface - D) cut out of it.

Which surface another foot stands on matters no more after the step. No place is lost and none is
added, but for the slack of D: there is a plan with these surfaces if and only if no set is empty.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.search.bodies import Body
from jaxleas.contacts.search.displacements import Displacements
from jaxleas.contacts.search.regions import Plane, Region, sum_rows
from jaxleas.types import InputError

TWO = 2
NOWHERE = ""
"""Name of the place of a foot that has not moved yet, among names of surfaces."""


@dataclass(frozen=True, eq=False)
class PlaceSet:
    """A set of places of the anchor.

    Attributes:
        step: number of steps made.
        surface: name of the surface that the anchor stands on, or NOWHERE.
        region: its places.
        landed: name of the surface on which the step before landed, whatever foot is the anchor.
    """

    step: int
    surface: str
    region: Region
    landed: str = NOWHERE


@dataclass(frozen=True)
class Move:
    """One step as the sets see it.

    Attributes:
        candidates: names of the surfaces that it may land on.
        body: displacements of the landing foot from the anchor; None where there are none.
        changes: whether the landing foot is the next anchor.
    """

    candidates: tuple[str, ...]
    body: Body | None
    changes: bool

    @cached_property
    def back(self) -> Body | None:
        """Displacements of the anchor from the landing foot."""
        return None if self.body is None else self.body.reversed()


class Ground:
    """The corners of some surfaces, laid end to end.

    Attributes:
        corners: all corners [m].
        starts: index of the first corner of each surface.
        low: least coordinates of each surface [m].
        high: greatest coordinates of each surface [m].
    """

    def __init__(self, corners: list[np.ndarray]) -> None:
        self.corners = np.concatenate(corners)
        self.starts = np.cumsum([0, *(len(each) for each in corners)])[:-1]
        self.low, self.high = self.along(np.eye(3))

    def along(self, directions: Float[np.ndarray, "n 3"]) -> tuple[np.ndarray, np.ndarray]:
        """Return how near and how far each surface lies in each direction [m]."""
        far = self.corners @ directions.T
        return np.minimum.reduceat(far, self.starts), np.maximum.reduceat(far, self.starts)


@dataclass(eq=False)
class ForwardSets:
    """The sets of a problem, and how they follow from each other.

    Attributes:
        problem: the contact problem, of two feet.
        propagations: number of sets computed.

    Raises:
        InputError: the problem is not one of two feet.
    """

    problem: ContactProblem
    propagations: int = field(default=0, init=False)
    _wholes: dict[str, Region] = field(default_factory=dict, init=False)
    _landings: dict[tuple[str, int], tuple[np.ndarray, np.ndarray]] = field(
        default_factory=dict, init=False
    )
    _grounds: "dict[tuple[str, ...], Ground]" = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        if len(self.problem.effectors) != TWO:
            raise InputError(
                f"the astar planner plans for two feet, and {len(self.problem.effectors)} stand"
                f" here ({', '.join(self.problem.effectors)}): ask for the planner mip"
            )

    @cached_property
    def moves(self) -> list[Move]:
        """The steps."""
        asked, made = self.problem, Displacements(self.problem)
        yaws = {name: pose.yaw for name, pose in asked.initial.items()}
        moves = []
        for index, step in enumerate(asked.steps):
            (anchor,) = (name for name in yaws if name != step.foot)
            body = made.of(step.foot, anchor, step.yaw, yaws[anchor])
            after = asked.steps[index + 1].foot if index + 1 < len(asked) else anchor
            moves.append(Move(step.candidates, body, after != step.foot))
            yaws[step.foot] = step.yaw
        return moves

    def whole(self, name: str) -> Region:
        """Return the whole of a surface."""
        if name not in self._wholes:
            self._wholes[name] = Region.of(self.problem.surfaces[name])
        return self._wholes[name]

    def ground(self, names: tuple[str, ...]) -> "Ground":
        """Return the corners of all of some surfaces."""
        if names not in self._grounds:
            self._grounds[names] = Ground([self.problem.surfaces[name].vertices for name in names])
        return self._grounds[names]

    @cached_property
    def start(self) -> PlaceSet:
        """The place of the foot that stands in the first step."""
        first = self.problem.steps[0].foot
        (pose,) = (pose for name, pose in self.problem.initial.items() if name != first)
        return PlaceSet(0, NOWHERE, Region(Plane.level(pose.position), np.zeros((1, 2))))

    def after(self, held: PlaceSet, allowed: "frozenset[str] | set[str]") -> Iterator[PlaceSet]:
        """Yield the sets that follow from one by its next step, those that are not empty.

        Args:
            held: set to step from.
            allowed: names of surfaces that the step may land on.
        """
        move = self.moves[held.step]
        near = [name for name in self.near(held) if name in allowed]
        if not near or move.body is None:
            return
        if not move.changes:
            yield from self._carried(held, move, near)
            return
        normals, bounds = sum_rows(held.region, move.body)
        self.propagations += len(near)
        for name in near:
            region = self.whole(name).clipped(normals, bounds)
            if region is not None:
                yield PlaceSet(held.step + 1, name, region, name)

    def _carried(self, held: PlaceSet, move: Move, near: list[str]) -> Iterator[PlaceSet]:
        self.propagations += len(near)
        for name in near:
            region = held.region.clipped(*self._landing(name, move))
            if region is not None:
                yield PlaceSet(held.step + 1, held.surface, region, name)

    def _landing(self, name: str, move: Move) -> tuple[np.ndarray, np.ndarray]:
        """Return half-spaces of the places of the anchor from which a surface can be reached."""
        assert move.back is not None
        key = name, id(move.body)
        if key not in self._landings:
            self._landings[key] = sum_rows(self.whole(name), move.back)
        return self._landings[key]

    def near(self, held: PlaceSet) -> list[str]:
        """Return the candidates whose boxes the next step reaches from a set."""
        move = self.moves[held.step]
        if move.body is None:
            return []
        low = held.region.vertices.min(axis=0) + move.body.low
        high = held.region.vertices.max(axis=0) + move.body.high
        ground = self.ground(move.candidates)
        met = ((ground.low <= high) & (ground.high >= low)).all(axis=1)
        return [move.candidates[index] for index in np.flatnonzero(met)]
