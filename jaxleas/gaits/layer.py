"""The states that a beam search keeps after a number of phases."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import Command, PlanningState
from jaxleas.gaits.gait import taken

CELL_OF_FEET, CELL_OF_BASE = 0.03, 0.05
"""States whose feet and base lie in the same cells of these sizes count as one [m]."""


@dataclass(frozen=True, eq=False)
class Layer:
    """The states that are kept after a number of phases.

    Attributes:
        states: states.
        owner: robot of each.
        parent: place of each state's parent in the layer before.
        commands: commands that led to them.
        worth: promise of each state.
    """

    states: PlanningState
    owner: np.ndarray
    parent: np.ndarray
    commands: Command
    worth: Float[np.ndarray, " N"]

    def kept(self, places: np.ndarray) -> "Layer":
        """Return the layer with some of its states alone."""
        return Layer(
            taken(self.states, places),
            self.owner[places],
            self.parent[places],
            taken(self.commands, places),
            self.worth[places],
        )


def promising(layer: Layer, seen: list[set[bytes]], width: int) -> np.ndarray:
    """Return the places of the states to keep: the most promising of each robot, none twice."""
    phase = layer.states.phase
    cells = np.concatenate(
        [
            np.rint(phase.feet[..., :2].reshape(len(layer.owner), -1) / CELL_OF_FEET),
            np.rint(phase.com[:, :2] / CELL_OF_BASE),
            phase.support[:, None],
        ],
        axis=1,
    ).astype(np.int16)
    kept: list[int] = []
    counts = np.zeros(len(seen), int)
    for place in np.argsort(-layer.worth, kind="stable"):
        robot, key = layer.owner[place], cells[place].tobytes()
        if counts[robot] < width and key not in seen[robot]:
            seen[robot].add(key)
            counts[robot] += 1
            kept.append(int(place))
    return np.array(kept, np.intp)
