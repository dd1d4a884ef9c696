"""The search of surfaces by forward sets, and the program that places the feet on them."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import make_constraints
from jaxleas.contacts.programs.placement import Placement, place
from jaxleas.contacts.search.advance import Advance
from jaxleas.contacts.search.best_first import BestFirst, Graph, OutOfTimeError
from jaxleas.contacts.search.displacements import SLACK
from jaxleas.contacts.search.forward_sets import ForwardSets, PlaceSet
from jaxleas.contacts.search.hopeless import surfaces_that_lead_on

SearchStatus = Literal["optimal", "infeasible", "time_limit", "failed", "marginal"]
Kept = dict[tuple[int, str], list[PlaceSet]]
"""Sets that no other one holds, by number of steps and the anchor's surface."""


@dataclass(frozen=True, eq=False)
class SetsDecision:
    """The answer of the search.

    Attributes:
        status: "optimal" for a plan; "infeasible" for proof that there is none; "marginal" where
            the sets say that there is one and the program says, within its tolerance, that not.
        surfaces: surface of each step.
        placement: footholds and centre of mass.
        sets: the problem's sets, for a proof.
        kept: sets that no other one holds.
        leading: surfaces that lead on after each number of steps.
        advance: how far towards the goal the anchor must be.
        images: sets that follow from each one by a step onto surfaces that lead on.
        expansions: number of sets stepped from.
    """

    status: SearchStatus
    surfaces: tuple[str, ...] = ()
    placement: Placement | None = None
    sets: ForwardSets | None = None
    kept: Kept = field(default_factory=dict)
    leading: list[frozenset[str]] = field(default_factory=list)
    advance: Advance | None = None
    images: dict[PlaceSet, list[PlaceSet]] = field(default_factory=dict)
    expansions: int = 0


def decide_by_sets(problem: ContactProblem, deadline: float = np.inf) -> SetsDecision:
    """Find a plan or prove that there is none.

    Args:
        problem: the contact problem, of two feet.
        deadline: time by `time.perf_counter` after which to stop [s].

    Raises:
        InputError: the problem is not one of two feet.
    """
    sets = ForwardSets(problem)
    leading = surfaces_that_lead_on(sets)
    kept: Kept = defaultdict(list)
    advance = Advance.of(sets)
    images: dict[PlaceSet, list[PlaceSet]] = {}
    search = BestFirst(_graph(sets, (leading, advance), kept, images))
    marginal = False
    try:
        for goal in search.goals([sets.start], deadline):
            surfaces = tuple(each.landed for each in goal.path()[1:])
            placement = _place(sets, surfaces, deadline)
            if placement.status == "optimal":
                return SetsDecision("optimal", surfaces, placement, expansions=search.expansions)
            if placement.status != "infeasible":
                return SetsDecision(placement.status, expansions=search.expansions)
            marginal = True
    except OutOfTimeError:
        return SetsDecision("time_limit", expansions=search.expansions)
    status = "marginal" if marginal else "infeasible"
    return SetsDecision(status, (), None, sets, kept, leading, advance, images, search.expansions)


def _place(sets: ForwardSets, surfaces: tuple[str, ...], deadline: float) -> Placement:
    """Place the feet, with all faces of the displacements, so that no cut is left to be found."""
    constraints = []
    for constraint, move in zip(make_constraints(sets.problem), sets.moves, strict=True):
        assert move.body is not None
        link = replace(constraint.link, A=move.body.normals, b=move.body.offsets - SLACK)
        constraints.append(replace(constraint, links=(link,)))
    return place(sets.problem, constraints, surfaces, deadline)


def _graph(
    sets: ForwardSets,
    hope: tuple[list[frozenset[str]], Advance],
    kept: Kept,
    images: dict[PlaceSet, list[PlaceSet]],
) -> Graph[PlaceSet]:
    """Return the sets as a graph: each step costs one, and exactly the rest remains."""
    count = len(sets.problem)
    leading, advance = hope

    def successors(held: PlaceSet) -> list[tuple[float, PlaceSet]]:
        move = sets.moves[held.step]
        allowed = leading[held.step + 1] if move.changes else frozenset(move.candidates)
        images[held] = list(sets.after(held, allowed))
        return [(1.0, each) for each in images[held]]

    def heuristic(held: PlaceSet) -> float:
        if held.surface not in leading[held.step] or advance.falls_short(held):
            return np.inf
        return float(count - held.step)

    def admits(held: PlaceSet) -> bool:
        others = kept[held.step, held.surface]
        if any(other.region.contains(held.region) for other in others):
            return False
        others[:] = [other for other in others if not held.region.contains(other.region)]
        others.append(held)
        return True

    def needs(held: PlaceSet) -> bool:
        return any(other is held for other in kept[held.step, held.surface])

    return Graph(
        successors=successors,
        heuristic=heuristic,
        is_goal=lambda held: held.step == count,
        order=_nearest_goal_first(sets),
        admits=admits,
        needs=needs,
    )


def _nearest_goal_first(sets: ForwardSets) -> Callable[[PlaceSet], tuple[int, float]]:
    """Return the order in which sets are taken: most steps made, then nearest to the goal."""
    middle = sets.ground(sets.moves[-1].candidates).corners.mean(axis=0)

    def order(held: PlaceSet) -> tuple[int, float]:
        away = held.region.vertices - middle
        return -held.step, float(np.sqrt((away * away).sum(axis=1)).min())

    return order
