"""Verification of a proof that there is no plan, by linear programs.

Shares no code with the planners. By induction over the steps, the places of the anchor, the foot
that stands while the next step is made, lie in sets of the proof: at the beginning in the first
one, and after each step in the set to which the proof says that it leads, which holds all places
that the step allows. A step that leads nowhere has no room; after the last step there is no set.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from jaxleas.contacts.infeasibility import FIRST_PLACE, InfeasibilityProof, ProofSet
from jaxleas.contacts.problem import TWO, ContactProblem
from jaxleas.contacts.proof_polygons import (
    dent,
    far_apart,
    half_spaces,
    off_plane,
    stick_out,
)
from jaxleas.contacts.proof_programs import Stance, StepProgram, stances_of_steps

EXACT = 1e-9
"""A place may be outside the set that must hold it by this [m]."""
LEAST_LACK = 1e-9
"""A step that cannot be made must lack more room than this [m]."""


WIDE = 100.0
"""Steps of which a coordinate can be about this long [m] are never refused unseen."""


@dataclass(frozen=True)
class ProofReport:
    """What became of a proof.

    Attributes:
        complaint: sentence that says what is wrong; empty for a proof that holds.
        sets: number of sets.
        programs: number of pairs of a set and a surface that took linear programs.
    """

    complaint: str
    sets: int
    programs: int

    @property
    def holds(self) -> bool:
        """Whether there is no plan."""
        return not self.complaint


class _FlawError(Exception):
    """Something in a proof that does not hold; its text says what."""


def certify_infeasible(
    problem: ContactProblem,
    proof: InfeasibilityProof,
    on_set: Callable[[int], None] = lambda done: None,
) -> ProofReport:
    """Verify that a problem has no plan.

    Args:
        problem: the contact problem, of two feet.
        proof: proof to verify.
        on_set: function that is called with the number of sets verified.
    """
    if len(problem.effectors) != TWO:
        return ProofReport("a proof is of two feet", len(proof.sets), 0)
    check = _Check(problem, proof)
    try:
        check.beginning()
        for number, held in enumerate(proof.sets):
            check.shape(number, held)
        for number, held in enumerate(proof.sets):
            check.steps(number, held)
            on_set(number + 1)
    except _FlawError as flaw:
        return ProofReport(str(flaw), len(proof.sets), check.programs)
    return ProofReport("", len(proof.sets), check.programs)


@dataclass(eq=False)
class _Check:
    problem: ContactProblem
    proof: InfeasibilityProof
    programs: int = 0
    stances: list[Stance] = field(init=False)
    boxes: dict[Stance, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.stances = stances_of_steps(self.problem)

    def beginning(self) -> None:
        """Require that the first set is where the first anchor stands."""
        first = self.proof.sets[0]
        if first.step != 0 or first.surface != FIRST_PLACE:
            raise _FlawError(f"set 0 is not the place where {self.stances[0].anchor} first stands")

    def steps(self, number: int, held: ProofSet) -> None:
        """Require that all that follows from a set lies in the sets to which it leads."""
        candidates = self.problem.steps[held.step].candidates
        stray = next((name for name in held.leads if name not in candidates), None)
        if stray is not None:
            raise _FlawError(f"set {number} leads onto '{stray}', no candidate of step {held.step}")
        for name in candidates:
            where = f"step {held.step} from set {number} onto '{name}'"
            if name in held.leads:
                self._require_inside(where, held, name, held.leads[name])
            else:
                self._require_impossible(where, held, name)

    def shape(self, number: int, held: ProofSet) -> None:
        """Require a convex polygon in the plane of its surface, before the last step."""
        if held.step >= len(self.problem):
            raise _FlawError(f"set {number} is of places after the last step, which a plan reaches")
        if held.surface == FIRST_PLACE:
            anchor = self.stances[held.step].anchor
            if np.abs(held.vertices - self.problem.initial[anchor].position).max() > EXACT:
                raise _FlawError(f"set {number} is not the place where {anchor} first stands")
        elif held.surface not in self.problem.surfaces:
            raise _FlawError(f"set {number} is on '{held.surface}', no surface of the problem")
        else:
            corners = self.problem.surfaces[held.surface].vertices
            if off_plane(corners, held.vertices) > EXACT:
                raise _FlawError(f"set {number} is not in the plane of '{held.surface}'")
        if dent(held.vertices, self._normal(held.surface)) > EXACT:
            raise _FlawError(f"set {number} is no convex polygon")

    def _normal(self, surface: str) -> np.ndarray:
        if surface == FIRST_PLACE:
            return np.array([0.0, 0.0, 1.0])
        corners = self.problem.surfaces[surface].vertices
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        return normal / np.sqrt(normal @ normal)

    def _require_impossible(self, where: str, held: ProofSet, name: str) -> None:
        landing = self.problem.surfaces[name].vertices
        if far_apart(held.vertices, landing, self._reach(self.stances[held.step])):
            return
        room = self._program(held, landing).room()
        if room >= -LEAST_LACK:
            raise _FlawError(f"{where} can be made, with {max(room, 0.0):.3g} m to spare")

    def _require_inside(self, where: str, held: ProofSet, name: str, ahead: int) -> None:
        after, landing = self.proof.sets[ahead], self.problem.surfaces[name].vertices
        steps = self.problem.steps
        landed = held.step + 1 == len(steps) or steps[held.step + 1].foot != steps[held.step].foot
        if after.step != held.step + 1 or after.surface != (name if landed else held.surface):
            raise _FlawError(f"{where} leads to set {ahead}, which is of another step or surface")
        normals, bounds = half_spaces(after.vertices, self._normal(after.surface))
        if stick_out(landing if landed else held.vertices, normals, bounds) <= 0.0:
            return  # whatever the step allows
        program = self._program(held, landing)
        for normal, bound in zip(normals, bounds, strict=True):
            beyond = program.furthest(normal, landed) - bound
            if beyond > EXACT:
                raise _FlawError(f"{where} reaches {beyond:.3g} m beyond set {ahead}")

    def _program(self, held: ProofSet, landing: np.ndarray) -> StepProgram:
        self.programs += 1
        return StepProgram(self.problem, self.stances[held.step], held.vertices, landing)

    def _reach(self, stance: Stance) -> np.ndarray:
        """Return the least and greatest coordinates of a step, by six linear programs [m]."""
        if stance not in self.boxes:
            corners = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
            wide = WIDE * np.array(corners, float)
            program = StepProgram(self.problem, stance, np.zeros((1, 3)), wide)
            axes = np.concatenate([-np.eye(3), np.eye(3)])
            far = np.array([program.furthest(axis, landed=True) for axis in axes])
            far = np.where(far > 0.9 * WIDE, np.inf, far)
            self.boxes[stance] = np.stack([-far[:3], far[3:]])
        return self.boxes[stance]
