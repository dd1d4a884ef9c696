"""Why a step cannot be made: the family of constraints that prevents it, and by how much."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import Family
from jaxleas.contacts.programs.decision import decide
from jaxleas.contacts.programs.linear_program import SolverStatus
from jaxleas.contacts.surfaces import ContactSurface

WORDS = {
    "step": "reach of the step",
    "com_reach": "reach of the centre of mass",
    "com_over": "room for the centre of mass over the foot",
    "edges": "surface beyond the edges",
    "together": "reach of the step and of the centre of mass together",
}
LADDER = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Amounts by which a family is relaxed [m]; one that needs more is not to blame."""


@dataclass(frozen=True)
class Blame:
    """Changes that would make a step possible.

    Attributes:
        short: relaxation that suffices, for each family of constraints to blame [m].
        surface: surface of the scene that would suffice as a candidate, whole; empty if none.
        in_time: whether every question was answered before the deadline.
    """

    short: dict[str, float]
    surface: str = ""
    in_time: bool = True


def explain(problem: ContactProblem, step: int, deadline: float = np.inf) -> str:
    """Return a sentence on why `step` is the first step that cannot be made.

    Args:
        problem: problem whose steps before `step` can be made.
        step: index of the first step that cannot be made.
        deadline: time by `time.perf_counter` after which to stop [s].
    """
    failing = problem.steps[step]
    blame = find_blame(problem.prefix(step + 1), deadline)
    allowed = list(dict.fromkeys(problem.whole(name) for name in failing.candidates))
    names = ", ".join(f"'{name}'" for name in allowed[:6])
    more = len(allowed) - 6
    where = f"{names} and {more} more" if more > 0 else names
    helps = [
        f"with at most {metres:g} m more {WORDS[name]}"
        for name, metres in sorted(blame.short.items(), key=lambda item: item[1])
    ]
    if blame.surface in allowed:
        helps.append(f"onto another part of '{blame.surface}' than its candidate")
    elif blame.surface:
        helps.append(f"onto '{blame.surface}', which is not among its candidates")
    sentence = f"step {step} ({failing.foot} onto {where}) is the first step that cannot be made"
    end = "" if blame.in_time else "; the time ran out before all that would help was found"
    if helps:
        return f"{sentence}; it could be made {', or '.join(helps)}{end}"
    if end:
        return f"{sentence}{end}"
    return f"{sentence}; relaxing one family of constraints by {LADDER[-1]:g} m does not help"


def find_blame(prefix: ContactProblem, deadline: float = np.inf) -> Blame:
    """Relax each family of constraints, in the last step alone, until the steps can be made.

    Args:
        prefix: problem of which all but the last step can be made.
        deadline: time by `time.perf_counter` after which to stop [s].
    """
    families: tuple[Family, ...] = ("step",)
    if prefix.model == "two_com":
        families = ("step", "com_reach", "com_over")
    late = False

    def status(problem: ContactProblem, relaxed: dict[Family, float] | None = None) -> SolverStatus:
        nonlocal late
        found = decide(problem, deadline, relaxed=relaxed).status
        late = late or found == "time_limit"
        return found

    short = {}
    for family in families:
        short[family] = _least(lambda metres, f=family: status(prefix, {f: metres}))
    short["edges"] = _least(lambda metres: status(with_wider(prefix, metres)))
    if len(families) > 1 and all(short[family] is None for family in families):
        short["together"] = _least(lambda metres: status(prefix, dict.fromkeys(families, metres)))
    surface = _other_surface(prefix, deadline)
    found = {family: metres for family, metres in short.items() if metres is not None}
    return Blame(found, surface, not late)


def _least(status: Callable[[float], SolverStatus]) -> float | None:
    """Return the smallest amount of the ladder that suffices, by bisection."""
    failed, enough = -1, len(LADDER)
    while enough - failed > 1:
        middle = (failed + enough) // 2 if enough < len(LADDER) else len(LADDER) - 1
        answer = status(LADDER[middle])
        if answer == "optimal":
            enough = middle
        elif middle == len(LADDER) - 1:
            return None
        elif answer == "infeasible":
            failed = middle
        else:  # no answer: return the amount that is known to suffice
            break
    return LADDER[enough]


def _other_surface(prefix: ContactProblem, deadline: float) -> str:
    others = tuple(
        name for name in prefix.whole_surfaces if name not in prefix.steps[-1].candidates
    )
    if not others:
        return ""
    before = [step.candidates for step in prefix.steps[:-1]]
    return next(iter(decide(prefix.with_candidates([*before, others]), deadline).surfaces[-1:]), "")


def with_wider(problem: ContactProblem, metres: float) -> ContactProblem:
    """Return the problem with every edge of the last step's candidates moved outwards [m]."""
    surfaces, names = dict(problem.surfaces), []
    for name in problem.steps[-1].candidates:
        names.append(f"{name} widened")
        surfaces[names[-1]] = _widened(problem.surfaces[name], metres)
    before = [step.candidates for step in problem.steps[:-1]]
    return replace(problem, surfaces=surfaces).with_candidates([*before, tuple(names)])


def _widened(surface: ContactSurface, metres: float) -> ContactSurface:
    """Move each corner to where its two edges meet after both have moved outwards."""
    after, before = surface.edge_normals, np.roll(surface.edge_normals, 1, axis=0)
    along = (after + before) / (1.0 + np.einsum("vk,vk->v", after, before))[:, None]
    return ContactSurface(surface.vertices + metres * along)
