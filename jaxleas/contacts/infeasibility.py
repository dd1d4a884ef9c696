"""A proof that a contact problem has no plan, as a value and in JSON.

A proof is a list of convex sets of places of the *anchor*, the foot that stands while the next step
is made: the first is where it stands at the beginning, and each set says, for each surface on which
its next step can land, which set holds all places of the next anchor. No set is left after the last
step. `proof_check` verifies it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError

FIRST_PLACE = ""
"""Name of the place of a foot that has not moved, among names of surfaces."""


@dataclass(frozen=True, eq=False)
class ProofSet:
    """A convex set of places of the anchor.

    Attributes:
        step: number of steps made before; the next step has this index.
        surface: name of the surface that the anchor stands on, or FIRST_PLACE.
        vertices: corners of the set, in order [m].
        leads: index of the set after the next step, for each surface that it may land on; a step
            onto a candidate that is not named cannot be made from here.
    """

    step: int
    surface: str
    vertices: Float[np.ndarray, "n 3"]
    leads: Mapping[str, int]


@dataclass(frozen=True, eq=False)
class InfeasibilityProof:
    """A proof that there is no plan.

    Attributes:
        sets: sets of places, the first one that of the beginning.
    """

    sets: tuple[ProofSet, ...]


def proof_to_json(proof: InfeasibilityProof) -> list[dict[str, Any]]:
    """Return the JSON of a proof."""
    return [
        {
            "step": each.step,
            "surface": each.surface or None,
            "vertices": each.vertices.tolist(),
            "leads": dict(each.leads),
        }
        for each in proof.sets
    ]


def proof_from_json(where: str, content: Any) -> InfeasibilityProof:
    """Return the proof in parsed JSON.

    Args:
        where: name of the file and the key, for messages.
        content: parsed list.

    Raises:
        InputError: an entry (named) cannot be used.
    """
    if not isinstance(content, list) or not content:
        raise InputError(f"{where} must be a list of at least one set, or null")
    return InfeasibilityProof(
        tuple(
            _set(f"{where}: set {index}", each, len(content)) for index, each in enumerate(content)
        )
    )


def _set(where: str, content: Any, count: int) -> ProofSet:
    needed = {"step", "surface", "vertices", "leads"}
    if not isinstance(content, dict) or not needed <= set(content):
        raise InputError(f"{where} must be an object with step, surface, vertices and leads")
    step, surface, leads = content["step"], content["surface"], content["leads"]
    if not _is_whole(step) or step < 0:
        raise InputError(f"{where}: step must be a whole number from 0 on, not {step!r:.60}")
    if surface is not None and (not isinstance(surface, str) or not surface):
        raise InputError(f"{where}: surface must be a name, or null, not {surface!r:.60}")
    if not isinstance(leads, dict) or not all(
        _is_whole(index) and 0 <= index < count for index in leads.values()
    ):
        raise InputError(f"{where}: leads must give each surface the index of a set, below {count}")
    return ProofSet(step, surface or FIRST_PLACE, _vertices(where, content["vertices"]), leads)


def _vertices(where: str, content: Any) -> np.ndarray:
    wanted = f"{where}: vertices must be a list of at least one [x, y, z], finite numbers in metres"
    try:
        vertices = np.array(content)
        if vertices.dtype.kind not in "iuf":
            raise ValueError("not numbers")
        vertices = vertices.astype(np.float64)
    except (OverflowError, TypeError, ValueError) as error:
        raise InputError(wanted) from error
    if vertices.ndim != 2 or vertices.shape[1:] != (3,) or not np.isfinite(vertices).all():
        raise InputError(wanted)
    return vertices


def _is_whole(content: Any) -> bool:
    return isinstance(content, int) and not isinstance(content, bool)
