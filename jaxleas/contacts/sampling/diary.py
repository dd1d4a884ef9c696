"""Postures of many guide paths, recorded in the order they are made, returned by path."""

from collections.abc import Sequence
from dataclasses import fields
from time import perf_counter

import numpy as np

from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.plan import Ending, How, SamplingPlan
from jaxleas.contacts.sampling.stance import Stances, no_stances

_HOWS: tuple[How, ...] = ("start", "kept", "stepped", "repositioned")


class Diary:
    """Postures in the order in which they were made."""

    def __init__(self) -> None:
        self._entries: list[tuple] = []

    def write(
        self,
        how: How,
        guide: np.ndarray,
        at: np.ndarray,
        limb: np.ndarray | int,
        stances: Stances,
        com: np.ndarray,
    ) -> None:
        """Record one posture for each of some guide paths."""
        if len(guide):
            every = np.arange(len(guide))
            kind = np.full(len(guide), _HOWS.index(how))
            moved = np.broadcast_to(limb, guide.shape)
            self._entries.append((guide, at.copy(), kind, moved, stances[every], com))

    def plans(
        self,
        case: PlanningCase,
        guides: KeptGuides,
        ends: Sequence[tuple[Ending, str]],
        begun: float,
    ) -> list[SamplingPlan]:
        """Return the record of each guide path, with the robustness of every posture.

        Args:
            case: robot, scene, settings.
            guides: guide paths that were followed.
            ends: ending of each path, and the sentence that says what stopped it.
            begun: time of the start, by `perf_counter` [s].
        """
        names = case.ground.names
        guide, at, kind, moved, com, stances = self._columns(case)
        robustness = case.robustness(stances, com) if len(guide) else np.zeros(0)
        order = np.argsort(guide, kind="stable")
        bounds = np.searchsorted(guide[order], np.arange(len(ends) + 1))
        seconds = (perf_counter() - begun) / len(ends)
        plans = []
        for number, (ending, reason) in enumerate(ends):
            rows = order[bounds[number] : bounds[number + 1]]
            last = int(at[rows[-1]]) if len(rows) else -1
            plans.append(
                SamplingPlan(
                    ending=ending,
                    reason=reason,
                    last_index=int(guides.index[number, last]) if last >= 0 else -1,
                    last_kept=last,
                    kept=int(guides.length[number]),
                    index=guides.index[number, at[rows]],
                    how=tuple(_HOWS[each] for each in kind[rows]),
                    moved=moved[rows],
                    soles=stances.sole[rows],
                    rotations=stances.rotation[rows],
                    surfaces=tuple(
                        tuple(names[each] for each in row) for row in stances.surface[rows]
                    ),
                    com=com[rows],
                    robustness=robustness[rows],
                    repositions=int((kind[rows] == _HOWS.index("repositioned")).sum()),
                    seconds=seconds,
                )
            )
        return plans

    def _columns(
        self, case: PlanningCase
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, Stances]:
        if not self._entries:
            nothing = np.zeros(0, dtype=np.int64)
            return nothing, nothing, nothing, nothing, np.zeros((0, 3)), no_stances(case.legs, 0)
        guide, at, kind, moved, stances, com = zip(*self._entries, strict=True)
        together = Stances(
            *(
                np.concatenate([getattr(each, field.name) for each in stances])
                for field in fields(Stances)
            )
        )
        index, place, event, limb, centre = (
            np.concatenate(column) for column in (guide, at, kind, moved, com)
        )
        return index, place, event, limb, centre, together
