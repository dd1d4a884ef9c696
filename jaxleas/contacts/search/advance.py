"""How far towards the goal an anchor must be after each number of steps: one direction, exactly.

In direction u a step takes the landing foot no further ahead of the anchor than its displacements
reach, h(u). So an anchor that is further from the goal than all steps that are left reach together
leads nowhere, wherever the surfaces are.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.search.forward_sets import NOWHERE, ForwardSets, PlaceSet

_OUTWARDS = 1e-9  # a set falls short by more than this, whatever rounding did [m]


@dataclass(frozen=True, eq=False)
class Advance:
    """The least that must be reached towards the goal.

    Attributes:
        direction: horizontal unit vector from the first anchor to the middle of the goal.
        least: least coordinate of the anchor in this direction, after each number of steps [m].
    """

    direction: Float[np.ndarray, " 3"]
    least: Float[np.ndarray, " n"]

    @classmethod
    def of(cls, sets: ForwardSets) -> "Advance":
        """Return the least advance of a problem."""
        corners = sets.ground(sets.moves[-1].candidates).corners
        direction = (corners.mean(axis=0) - sets.start.region.plane.origin) * [1.0, 1.0, 0.0]
        length = float(np.sqrt(direction @ direction))
        if length > 0.0:
            direction = direction / length
        least = [float((corners @ direction).min())]
        for move in reversed(sets.moves):
            step = 0.0
            if move.changes and move.body is not None:
                step = float(move.body.support(direction[None])[0])
            least.append(least[-1] - step)
        return cls(direction, np.array(least[::-1]))

    def falls_short(self, held: PlaceSet) -> bool:
        """Return whether no place of a set is far enough."""
        reached = float((held.region.vertices @ self.direction).max())
        return reached < self.least[held.step] - _OUTWARDS

    def short(self, sets: ForwardSets, step: int, surface: str) -> PlaceSet | None:
        """Return the places of a surface that are not far enough; None if all are."""
        whole = sets.start.region if surface == NOWHERE else sets.whole(surface)
        region = whole.clipped(self.direction[None], self.least[step : step + 1])
        return None if region is None else PlaceSet(step, surface, region)
