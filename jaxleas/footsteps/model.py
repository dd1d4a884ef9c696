"""Motion models of one controller: where a footstep under a command leads."""

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.features import COM, VELOCITY, Predictors
from jaxleas.types import MOVEMENTS, ControllerIdentity, InputError

FeetMode = Literal["absolute", "relative"]
"""How landings are predicted: as displacements over the ground, or as places in the robot's frame
after the footstep, put together with the predicted pose."""
MOTION = len(COM) + len(VELOCITY)
"""Number of outputs before those of the feet."""
LEVELS = {name: 10 if name == "forward" else 9 for name in MOVEMENTS}
"""Fastest tenth of its largest speed that each movement is asked for (thesis, section 4.1.1)."""
BACKWARD = "backward"
"""Key of the largest backward speed in the data; 0 or missing: no such command is given."""


@dataclass(frozen=True)
class Errors:
    """Errors on runs that a model has not seen.

    Attributes:
        landing: quantiles ("0.5", "0.95", "0.99") of the distance between the predicted and the
            actual place of a swinging foot [m].
        com: the same of the centre of mass, in the plane [m].
        yaw: the same of the heading [rad].
    """

    landing: dict[str, float]
    com: dict[str, float]
    yaw: dict[str, float]


@dataclass(frozen=True, eq=False)
class MotionModel:
    """Linear models of a footstep, one matrix a pair: 14 models, and those of the velocity.

    Attributes:
        controller: identity of the controller whose footsteps are predicted.
        predictors: choice of predictors that the models see.
        feet: how landings are predicted.
        weights: weights of each pair, from all predictors and 1 to displacement of the centre of
            mass (x, y, yaw), its velocity afterwards (x, y, z, yaw rate) and x, y of each swinging
            foot.
        fastest: largest speed of each movement in the data, and of walking backward if it is
            there [m/s or rad/s].
        longest_stride: largest displacement of the centre of mass in the data [m].
        largest_turn: largest change of the heading in the data [rad].
        errors: errors on unseen runs.
        provenance: files of footsteps, versions, command and machine.
    """

    controller: ControllerIdentity
    predictors: Predictors
    feet: FeetMode
    weights: tuple[Float[np.ndarray, "P+1 L"], ...]
    fastest: dict[str, float]
    longest_stride: float
    largest_turn: float
    errors: Errors
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        inputs = 10 + 2 * len(self.controller.feet) + 1
        if len(self.weights) != len(self.controller.pairs):
            raise InputError(
                f"weights of {len(self.weights)} pairs for a controller with"
                f" {len(self.controller.pairs)}"
            )
        for pair, weights in zip(self.controller.pairs, self.weights, strict=True):
            shape = (inputs, MOTION + 2 * len(pair))
            if weights.shape != shape or not np.isfinite(weights).all():
                raise InputError(
                    f"weights of shape {weights.shape} where finite ones of {shape} are needed"
                )

    def predict(self, pair: int, predictors: Float[np.ndarray, "N P"]) -> Float[np.ndarray, "N L"]:
        """Return what a footstep leads to, in the order of the columns of `weights`.

        Args:
            pair: index of the swinging pair.
            predictors: all predictors, as `predictors_of` returns them.
        """
        weights = self.weights[pair]
        return predictors @ weights[:-1] + weights[-1]

    def commands(self) -> Float[np.ndarray, "C 3"]:
        """Return the commands that the model can answer for, slow ones of a movement first.

        They are tenths of the controller's largest speeds, up to the fastest in the data.
        """
        names = (*MOVEMENTS, BACKWARD)
        directions = np.array(
            [(1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1), (-1, 0, 0)], float
        )
        forward, sideways, turning = self.controller.max_speeds
        speeds = (forward, sideways, sideways, turning, turning, forward)
        largest = dict(zip(names, speeds, strict=True))
        return np.array(
            [
                direction * level / 10 * largest[name]
                for name, direction in zip(names, directions, strict=True)
                for level in range(1, LEVELS.get(name, LEVELS[MOVEMENTS[0]]) + 1)
                if level / 10 * largest[name] <= self.fastest.get(name, 0.0) + 1e-9
            ]
        ).reshape(-1, 3)
