"""Postures of many guide paths, written down as they come about, handed out by path."""

import numpy as np

from jaxleas.contacts.sampling.ground import Ground
from jaxleas.contacts.sampling.guides import KeptGuides
from jaxleas.contacts.sampling.plan import How, SamplingPlan
from jaxleas.contacts.sampling.stance import Stances

_HOWS: tuple[How, ...] = ("start", "kept", "stepped", "repositioned")


class Diary:
    """Postures in the order in which they came about."""

    def __init__(self) -> None:
        self._entries: list[tuple[np.ndarray, ...]] = []

    def write(
        self,
        how: How,
        guide: np.ndarray,
        at: np.ndarray,
        limb: np.ndarray | int,
        stances: Stances,
        robustness: np.ndarray,
        com: np.ndarray,
    ) -> None:
        """Note one posture of each of some guide paths."""
        if len(guide):
            kind = np.full(len(guide), _HOWS.index(how))
            moved = np.broadcast_to(limb, guide.shape)
            feet = (stances.sole.copy(), stances.rotation.copy(), stances.surface.copy())
            self._entries.append((guide, at.copy(), kind, moved, *feet, robustness, com))

    def plans(
        self, guides: KeptGuides, ground: Ground, reasons: list[str], seconds: float
    ) -> list[SamplingPlan]:
        """Return what was noted of each guide path."""
        columns = self._columns()
        guide = columns[0]
        order = np.argsort(guide, kind="stable")
        bounds = np.searchsorted(guide[order], np.arange(len(reasons) + 1))
        plans = []
        for number, reason in enumerate(reasons):
            rows = order[bounds[number] : bounds[number + 1]]
            at, kind, moved, sole, rotation, surface, robustness, com = (
                column[rows] for column in columns[1:]
            )
            last = int(at[-1]) if len(at) else -1
            plans.append(
                SamplingPlan(
                    success=not reason,
                    reason=reason,
                    last_index=int(guides.index[number, last]) if last >= 0 else -1,
                    last_kept=last,
                    kept=int(guides.length[number]),
                    index=guides.index[number, at],
                    how=tuple(_HOWS[each] for each in kind),
                    moved=moved,
                    soles=sole,
                    rotations=rotation,
                    surfaces=tuple((ground.names[a], ground.names[b]) for a, b in surface),
                    com=com,
                    robustness=robustness,
                    repositions=int((kind == _HOWS.index("repositioned")).sum()),
                    seconds=seconds / len(reasons),
                )
            )
        return plans

    def _columns(self) -> list[np.ndarray]:
        if not self._entries:
            nothing = np.zeros(0, dtype=np.int64)
            feet = (np.zeros((0, 2, 3)), np.zeros((0, 2, 3, 3)), np.zeros((0, 2), dtype=np.int64))
            return [nothing, nothing, nothing, nothing, *feet, np.zeros(0), np.zeros((0, 3))]
        return [np.concatenate(column) for column in zip(*self._entries, strict=True)]
