"""The contact plan: a planner's answer, as a value and as a file (docs/contacts.md)."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.infeasibility import InfeasibilityProof, proof_from_json, proof_to_json
from jaxleas.contacts.plan_entries import (
    count,
    number,
    numbers,
    postures_of,
    robustness_of,
    word,
)
from jaxleas.contacts.posture import Posture, posture_to_json
from jaxleas.files import read_json, require_version, write_json
from jaxleas.types import CAUSES, ENDINGS, Cause, Ending, InputError

Status = Literal["feasible", "infeasible", "time_limit", "not_found"]
VERSION = 1
STATUSES: tuple[Status, ...] = ("feasible", "infeasible", "time_limit", "not_found")


@dataclass(frozen=True, eq=False)
class ContactPlan:
    """A planner's answer to one contact problem or guide path.

    Attributes:
        planner: name of the planner.
        feasible: whether a plan was found.
        status: "feasible"; "infeasible" (proved); "time_limit" (not decided in time); "not_found"
            (an incomplete planner gave up; proves nothing).
        reason: sentence that says why there is no plan; empty when there is one.
        surfaces: name of the surface of each planned step.
        footholds: foothold of each step, in the world [m].
        com: two positions of the centre of mass per step [m]; None where the planner has none.
        last_feasible_step: index of the last step that can be made (that of the last step when
            feasible, -1 when no step can be made); None when not requested.
        max_violation: largest violation of a constraint, by the certificate [m]; None without a
            plan.
        seconds: time spent planning [s].
        combinations: number of combinations of surfaces tried one after the other; None where a
            solver does that inside.
        undecided: number of steps that the L1 relaxation left without a surface; None for other
            planners than SL1M.
        robustness: robustness of each posture [N]; None for planners without postures.
        postures: poses of all feet at each kept configuration of the guide; None for planners
            without postures.
        gap: gap between a standing sole and its surface in these postures [m].
        cause: kind of reason for which there is no plan, where the planner states one; None for a
            plan.
        guide_ended: how the guide path ended that the plan follows, whatever the planner found;
            None for a problem without one.
        proof: proof that there is no plan, from a planner that writes one; else None.
    """

    planner: str
    feasible: bool
    status: Status
    reason: str = ""
    surfaces: tuple[str, ...] = ()
    footholds: Float[np.ndarray, "n 3"] | None = None
    com: Float[np.ndarray, "n 2 3"] | None = None
    last_feasible_step: int | None = None
    max_violation: float | None = None
    seconds: float = 0.0
    combinations: int | None = None
    undecided: int | None = None
    robustness: tuple[float, ...] | None = None
    postures: tuple[Posture, ...] | None = None
    gap: float = 0.0
    cause: Cause | None = None
    guide_ended: Ending | None = None
    proof: InfeasibilityProof | None = None

    @property
    def last_feasible_phase(self) -> int | None:
        """The former name of `last_feasible_step`, still that of the file's key."""
        return self.last_feasible_step

    def but(self, **changes: Any) -> "ContactPlan":
        """Return the plan with some attributes changed."""
        return replace(self, **changes)


def write_plan(path: str | Path, plan: ContactPlan) -> None:
    """Write a plan as JSON, whole or not at all."""
    postures = None if plan.postures is None else [posture_to_json(p) for p in plan.postures]
    certificate = None if plan.max_violation is None else {"max_violation_m": plan.max_violation}
    write_json(
        path,
        {
            "version": VERSION,
            "planner": plan.planner,
            "feasible": plan.feasible,
            "status": plan.status,
            "reason": plan.reason,
            "surfaces": list(plan.surfaces),
            "footholds": [] if plan.footholds is None else plan.footholds.tolist(),
            "com": None if plan.com is None else plan.com.tolist(),
            "last_feasible_phase": plan.last_feasible_step,
            "robustness": None if plan.robustness is None else list(plan.robustness),
            "certificate": certificate,
            "seconds": plan.seconds,
            "combinations": plan.combinations,
            "undecided": plan.undecided,
            "postures": postures,
            "gap": plan.gap,
            "cause": plan.cause,
            "guide_ended": plan.guide_ended,
            "proof": None if plan.proof is None else proof_to_json(plan.proof),
        },
    )


def read_plan(path: str | Path) -> ContactPlan:
    """Read a plan from JSON.

    Raises:
        InputError: the file is not a plan; says which key is wrong.
    """
    content = read_json(path)
    needed = ("planner", "feasible", "status", "surfaces", "footholds")
    if not isinstance(content, dict) or not all(key in content for key in needed):
        raise InputError(f"{path} is not a contact plan: it needs the keys {', '.join(needed)}")
    require_version(content, VERSION, path)
    if content["status"] not in STATUSES or not isinstance(content["feasible"], bool):
        raise InputError(
            f"{path}: status must be one of {', '.join(STATUSES)} and feasible true or false"
        )
    surfaces = content["surfaces"]
    if not isinstance(surfaces, list) or not all(isinstance(name, str) for name in surfaces):
        raise InputError(f"{path}: surfaces must be a list of surface names, one per step")
    com, postures, proof = (content.get(key) for key in ("com", "postures", "proof"))
    certificate = content.get("certificate") or {}
    if not isinstance(certificate, dict):
        raise InputError(f"{path}: certificate must be an object with max_violation_m, or null")
    return ContactPlan(
        planner=str(content["planner"]),
        feasible=content["feasible"],
        status=content["status"],
        reason=str(content.get("reason") or ""),
        surfaces=tuple(surfaces),
        footholds=numbers(path, "footholds", content["footholds"], (len(surfaces), 3)),
        com=None if com is None else numbers(path, "com", com, (len(surfaces), 2, 3)),
        last_feasible_step=count(path, content, "last_feasible_phase"),
        max_violation=number(path, certificate, "max_violation_m"),
        seconds=number(path, content, "seconds") or 0.0,
        combinations=count(path, content, "combinations"),
        undecided=count(path, content, "undecided"),
        robustness=robustness_of(path, content.get("robustness")),
        postures=None if postures is None else postures_of(path, postures),
        gap=number(path, content, "gap") or 0.0,
        cause=word(path, content, "cause", CAUSES),
        guide_ended=word(path, content, "guide_ended", ENDINGS),
        proof=None if proof is None else proof_from_json(f"{path}: proof", proof),
    )
