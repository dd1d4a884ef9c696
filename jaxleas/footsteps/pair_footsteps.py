"""The footsteps of one pair: predictors, labels, and what is held out together."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float, Int

from jaxleas.footsteps.features import (
    COM,
    Predictors,
    absolute_feet,
    columns_for,
    com_labels,
    local_feet,
    predictors_of,
    relative_feet,
    velocity_labels,
)
from jaxleas.footsteps.folds import SPLITS, Split, folds_of
from jaxleas.footsteps.model import FeetMode
from jaxleas.footsteps.records import Footsteps
from jaxleas.types import ControllerIdentity

MODES: tuple[FeetMode, ...] = ("absolute", "relative")


@dataclass(frozen=True, eq=False)
class Target:
    """One displacement that is predicted.

    Attributes:
        name: name such as "com x" or "LF y".
        feet: how a foot is predicted; "" for the centre of mass.
        labels: its values [m or rad].
    """

    name: str
    feet: str
    labels: Float[np.ndarray, " N"]


@dataclass(frozen=True, eq=False)
class PairFootsteps:
    """Footsteps in which one pair swings.

    Attributes:
        name: names of the feet that swing, such as "LF/RH".
        swinging: their indices.
        feet: names of all feet.
        predictors: all predictors.
        com: displacement of the centre of mass, x, y [m] and yaw [rad].
        velocity: velocity afterwards [m/s], and yaw rate [rad/s].
        landings: places of the swinging feet by how they are predicted [m].
        lift_offs: places of the swinging feet at the beginning, in the robot's frame there [m].
        movement: movement that is commanded, by name.
        folds: number of the fold of each footstep, by split.
    """

    name: str
    swinging: tuple[int, ...]
    feet: tuple[str, ...]
    predictors: Float[np.ndarray, "N P"]
    com: Float[np.ndarray, "N 3"]
    velocity: Float[np.ndarray, "N 4"]
    landings: dict[FeetMode, Float[np.ndarray, "N S 2"]]
    lift_offs: Float[np.ndarray, "N S 2"]
    movement: np.ndarray
    folds: dict[Split, Int[np.ndarray, " N"]]

    @classmethod
    def of(cls, steps: Footsteps, pair: int, controller: ControllerIdentity, seed: int) -> Self:
        """Return the footsteps of a pair.

        Args:
            steps: footsteps of all pairs.
            pair: index of the pair.
            controller: identity of the controller that made them.
            seed: seed of the folds.
        """
        chosen = steps.at(steps.pair == pair)
        swinging = controller.pairs[pair]
        index = list(swinging)
        return cls(
            name=controller.pair_names[pair],
            swinging=swinging,
            feet=controller.feet,
            predictors=predictors_of(chosen),
            com=com_labels(chosen),
            velocity=velocity_labels(chosen),
            landings={
                "absolute": absolute_feet(chosen)[:, index],
                "relative": relative_feet(chosen)[:, index],
            },
            lift_offs=local_feet(chosen)[:, index],
            movement=chosen.movement,
            folds={split: folds_of(split, chosen.run, seed) for split in SPLITS},
        )

    def targets(self) -> list[Target]:
        """Return what models of this pair predict: seven models, the feet in two ways."""
        com = [Target(name, "", self.com[:, axis]) for axis, name in enumerate(COM)]
        return com + [
            Target(f"{self.feet[foot]} {'xy'[axis]}", mode, self.landings[mode][:, column, axis])
            for mode in MODES
            for column, foot in enumerate(self.swinging)
            for axis in (0, 1)
        ]

    def columns(self, choice: Predictors, target: str) -> list[int]:
        """Return the indices of the predictors that the model of a target sees."""
        return columns_for(choice, target, self.swinging, len(self.feet))

    def outputs(self, mode: FeetMode) -> Float[np.ndarray, "N L"]:
        """Return all labels, in the order of the outputs of a `MotionModel`."""
        landings = self.landings[mode].reshape(len(self.com), -1)
        return np.column_stack([self.com, self.velocity, landings])
