"""Beam search over commands: the best states of each depth go on, all expanded at once."""

import numpy as np
from jaxtyping import Float, Int

from jaxleas.footsteps.expansion import Children, Expander, Node
from jaxleas.footsteps.features import wrapped
from jaxleas.footsteps.search_costs import Found, SearchCosts

MERGED_CELL, MERGED_YAW = 0.02, float(np.radians(2.0))
"""States of one command whose poses are in one cell count as one [m, rad]."""
SPARE = 2
"""States looked at for each that goes on: the swings of some hit the ground."""


def beam_search(
    expander: Expander, costs: SearchCosts, start: Node, horizon: int, width: int
) -> Found:
    """Return the best plan of those whose states are among the best of their depth.

    States are compared by what was spent and about what is left. Where none of a depth goes on,
    the plan ends at the best one there.

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
        kept = _kept(expander, children, goes_on, cost.total, width)
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
    totals: Float[np.ndarray, " C"],
    width: int,
) -> Int[np.ndarray, " W"]:
    """Return the rows that go on, the cheapest first: one of those that count as one."""
    rows = rows[np.argsort(totals[rows], kind="stable")]
    rows = rows[_first_of_each(children, rows)][: SPARE * width]
    if not len(rows):
        return rows
    return rows[expander.swings_clear(children, rows)][:width]


def _first_of_each(children: Children, rows: Int[np.ndarray, " K"]) -> Int[np.ndarray, " L"]:
    """Return the places, in ascending order, of the first rows of all that count as one."""
    x, y = np.floor(children.com[rows] / MERGED_CELL).astype(np.int64).T
    yaw = np.floor(wrapped(children.yaw[rows]) / MERGED_YAW).astype(np.int64)
    key = np.zeros(len(rows), dtype=np.int64)
    for part in (x, y, yaw, children.command[rows]):
        low = part.min(initial=0)
        key = key * (part.max(initial=0) - low + 1) + (part - low)
    return np.sort(np.unique(key, return_index=True)[1])


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
