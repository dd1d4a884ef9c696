"""Which surfaces lead nowhere: pairs of surfaces between which no step is possible, backwards.

Coarse and quick: a pair is impossible if one face of the displacements separates the surfaces.
"""

import numpy as np

from jaxleas.contacts.search.forward_sets import NOWHERE, ForwardSets, Move


def surfaces_that_lead_on(sets: ForwardSets) -> list[frozenset[str]]:
    """Return the surfaces from which an anchor may reach the goal, after each number of steps.

    After the last step each surface does. NOWHERE stands for the anchor's first place.
    """
    anchors = _anchors(sets)
    alive = [frozenset(anchors[-1])]
    pairs: dict[tuple, np.ndarray] = {}
    for move, names in zip(reversed(sets.moves), reversed(anchors[:-1]), strict=True):
        key = id(move.body), names, move.candidates
        if key not in pairs:
            pairs[key] = possible_pairs(sets, names, move)
        possible, ahead = pairs[key], alive[-1]
        if move.changes:
            possible = possible & np.array([name in ahead for name in move.candidates])
        kept = np.flatnonzero(possible.any(axis=1))
        leading = {names[index] for index in kept}
        alive.append(frozenset(leading if move.changes else leading & ahead))
    return alive[::-1]


def _anchors(sets: ForwardSets) -> list[tuple[str, ...]]:
    """Return the names of the surfaces that the anchor may stand on after each number of steps."""
    anchors: list[tuple[str, ...]] = [(NOWHERE,)]
    for move in sets.moves:
        anchors.append(move.candidates if move.changes else anchors[-1])
    return anchors


def possible_pairs(sets: ForwardSets, names: tuple[str, ...], move: Move) -> np.ndarray:
    """Return for each anchor's surface and each candidate whether no face separates them."""
    if move.body is None:
        return np.zeros((len(names), len(move.candidates)), bool)
    normals = move.body.normals
    least, _ = sets.ground(move.candidates).along(normals)
    if names == (NOWHERE,):
        most = (sets.start.region.vertices @ normals.T).max(axis=0)[None]
    else:
        _, most = sets.ground(names).along(normals)
    return np.all(least[None] <= most[:, None] + move.body.offsets, axis=-1)
