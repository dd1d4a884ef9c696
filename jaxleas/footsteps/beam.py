"""Beam search over commands: the best states of each depth go on, all expanded at once."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.features import wrapped
from jaxleas.footsteps.search_costs import Found, SearchCosts, StepCosts
from jaxleas.footsteps.search_states import Children, Node

MERGED_CELL, MERGED_YAW = 0.02, float(np.radians(2.0))
"""States of one command whose poses are in one cell count as one [m, rad]."""
SPARE = 2
"""States looked at for each that goes on: the swings of some hit the ground."""
STRATUM_LEFT, STRATUM_SPEED = 0.5, 0.2
"""States with as much left [footsteps] and as fast ahead [m/s] compete with one another first."""


def beam_search(
    expander: Expander, costs: SearchCosts, start: Node, horizon: int, width: int
) -> Found:
    """Return the best plan of those whose states are among the best of their depth.

    States are compared by what was spent and about what is left, first with those as near to the
    goal and as fast: otherwise those in front of a gap, which cannot cross it, would crowd out all
    that can. Where none of a depth goes on, the plan ends at the best one there.

    Args:
        expander: what predicts footsteps and refuses those that are not safe.
        costs: costs of footsteps towards a goal.
        start: state to begin in.
        horizon: number of footsteps of a plan that does not reach the goal.
        width: number of states that go on at each depth.
    """
    found, nodes = Found(), [start]
    for depth in range(1, horizon + 1):
        found.expansions += len(nodes)
        children = expander.children(nodes)
        cost = costs.of(children)
        there = costs.goal.is_met(children.com, children.yaw, children.velocity)
        _end(found, expander, children, np.flatnonzero(there), cost.total)
        goes_on = np.flatnonzero(~there & (cost.bound < found.cost))
        kept = _kept(expander, children, goes_on, cost, width)
        left_out = ~there
        left_out[kept] = depth == horizon  # what ends at the horizon goes on nowhere
        found.bound = min(found.bound, cost.bound[left_out].min(initial=np.inf))
        before = nodes
        nodes = [expander.child(children, row, float(cost.spent[row])) for row in kept.tolist()]
        if not nodes:
            if found.node is None and before[0].depth:
                found.take("budget", before[0], before[0].spent)
            break
        if depth == horizon and cost.total[kept[0]] < found.cost:
            found.take("horizon", nodes[0], float(cost.total[kept[0]]))
    found.bound = min(found.bound, found.cost)
    return found


def _kept(
    expander: Expander,
    children: Children,
    rows: Int[np.ndarray, " K"],
    cost: StepCosts,
    width: int,
) -> Int[np.ndarray, " W"]:
    """Return the rows that go on, the cheapest first: one of those that count as one.

    The best of each stratum come before the second best of any.
    """
    rows = rows[np.argsort(cost.total[rows], kind="stable")]
    rows = rows[_first_of_each(children, rows)]
    if not len(rows):
        return rows
    left = np.floor((cost.total - cost.spent)[rows] / STRATUM_LEFT)
    speed = np.floor(children.velocity[rows, 0] / STRATUM_SPEED)
    places = place_in_group(key_of((left, speed)))
    rows = rows[np.argsort(places, kind="stable")][: SPARE * width]
    rows = rows[expander.swings_clear(children, rows)][:width]
    return rows[np.argsort(cost.total[rows], kind="stable")]


def _first_of_each(children: Children, rows: Int[np.ndarray, " K"]) -> Int[np.ndarray, " L"]:
    """Return the places, in ascending order, of the first rows of all that count as one."""
    x, y = np.floor(children.com[rows] / MERGED_CELL).T
    yaw = np.floor(wrapped(children.yaw[rows]) / MERGED_YAW)
    key = key_of((x, y, yaw, children.command[rows]))
    return np.sort(np.unique(key, return_index=True)[1])


def key_of(parts: Sequence[np.ndarray]) -> Int[np.ndarray, " K"]:
    """Return one whole number for each combination of whole numbers."""
    key = np.zeros(len(parts[0]), dtype=np.int64)
    for part in parts:
        whole = part.astype(np.int64)
        low = whole.min(initial=0)
        key = key * (whole.max(initial=0) - low + 1) + (whole - low)
    return key


def place_in_group(keys: Int[np.ndarray, " K"]) -> Int[np.ndarray, " K"]:
    """Return for each row how many before it have the same key."""
    order = np.argsort(keys, kind="stable")
    begins = np.flatnonzero(np.diff(keys[order], prepend=keys[order[0]] - 1))
    places = np.empty(len(keys), dtype=np.int64)
    places[order] = np.arange(len(keys)) - np.repeat(begins, np.diff(begins, append=len(keys)))
    return places


def _end(
    found: Found,
    expander: Expander,
    children: Children,
    rows: Int[np.ndarray, " K"],
    totals: Float[np.ndarray, " C"],
) -> None:
    """Take the cheapest of the children at the goal whose swing is clear, if it is cheaper."""
    for row in rows[np.argsort(totals[rows], kind="stable")].tolist():
        if totals[row] >= found.cost:
            return
        if expander.swings_clear(children, np.array([row]))[0]:
            total = float(totals[row])
            found.take("reached", expander.child(children, row, total), total)
            return
