"""Footsteps of a walking controller: what each began with, what was commanded, where it ended.

A footstep is a transition between two moments at which all feet stand: one pair swings (Taouil's
thesis, section 4.1.2). Everything here is in the world; features and labels are made in the
robot's frame by those who need them.
"""

from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.types import MOVEMENTS, ControllerIdentity, InputError

Definition = Literal["thesis", "contact"]
"""How the ends of footsteps are found: by heights of the feet (thesis, fig. 4.3), or by measured
contact."""
STANDING, MIXED = "standing", "mixed"
"""What `movement_of` calls a zero command, and one that is no single movement."""


@dataclass(frozen=True, eq=False)
class Footsteps:
    """N footsteps of a controller with E feet, as arrays; all poses are in the world.

    Attributes:
        run: number of the run that a footstep belongs to: one robot, walking without a break.
        time: time at its end, since the beginning of its run [s].
        pair: index of the pair that swings, into the controller's pairs.
        com_before: position of the centre of mass at its beginning [m].
        com_after: the same at its end [m].
        yaw_before: heading of the trunk at its beginning [rad].
        yaw_after: the same at its end [rad].
        com_velocity_before: velocity of the centre of mass at its beginning [m/s].
        com_velocity_after: the same at its end [m/s].
        yaw_rate_before: turning rate of the trunk at its beginning [rad/s].
        yaw_rate_after: the same at its end [rad/s].
        feet_before: positions of the feet at its beginning [m].
        feet_after: the same at its end [m].
        previous_command: forward and sideways speed [m/s] and turning rate [rad/s] in the robot's
            frame that were commanded until its beginning.
        command: the same during it.
        apex: greatest height of the swinging feet above their lift-off [m]; NaN where unknown.
    """

    run: Int[np.ndarray, " N"]
    time: Float[np.ndarray, " N"]
    pair: Int[np.ndarray, " N"]
    com_before: Float[np.ndarray, "N 3"]
    com_after: Float[np.ndarray, "N 3"]
    yaw_before: Float[np.ndarray, " N"]
    yaw_after: Float[np.ndarray, " N"]
    com_velocity_before: Float[np.ndarray, "N 3"]
    com_velocity_after: Float[np.ndarray, "N 3"]
    yaw_rate_before: Float[np.ndarray, " N"]
    yaw_rate_after: Float[np.ndarray, " N"]
    feet_before: Float[np.ndarray, "N E 3"]
    feet_after: Float[np.ndarray, "N E 3"]
    previous_command: Float[np.ndarray, "N 3"]
    command: Float[np.ndarray, "N 3"]
    apex: Float[np.ndarray, " N"]

    def __len__(self) -> int:
        return len(self.run)

    def at(self, chosen: Int[np.ndarray, " M"] | Bool[np.ndarray, " N"]) -> "Footsteps":
        """Return the footsteps at these indices, or where a mask is true."""
        return replace(self, **{each.name: getattr(self, each.name)[chosen] for each in _ARRAYS})

    @property
    def movement(self) -> np.ndarray:
        """Movement that is commanded in each footstep, by name."""
        return movement_of(self.command)


@dataclass(frozen=True, eq=False)
class FootstepRecords:
    """Footsteps of one controller, with what a reader must know of their origin.

    Attributes:
        footsteps: the footsteps kept.
        controller: identity of the controller that made them.
        definition: how their ends were found.
        rejected: number of footsteps that were not kept, by reason.
        collection: settings of the collection, such as its seed, noise and variations.
        provenance: versions, command and machine that made the file.
    """

    footsteps: Footsteps
    controller: ControllerIdentity
    definition: Definition
    rejected: dict[str, int] = field(default_factory=dict)
    collection: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _require_consistent(self.footsteps, self.controller)


_ARRAYS = fields(Footsteps)
_WHOLE = ("run", "pair")
_SIZES = {"run": (), "time": (), "pair": (), "apex": (), "yaw": (), "yaw_rate": ()}


def movement_of(command: Float[np.ndarray, "N 3"]) -> np.ndarray:
    """Return the movement that each command asks for, by name: one of `MOVEMENTS`, or another.

    A zero command is "standing", and "mixed" is backward or more than one movement at a time.
    """
    forward, sideways, turning = (command[:, axis] for axis in range(3))
    alone = (command != 0.0).sum(axis=1) == 1
    wanted = (forward > 0, sideways > 0, sideways < 0, turning < 0, turning > 0)
    standing = (command == 0.0).all(axis=1)
    return np.select(
        [standing, *(alone & each for each in wanted)], [STANDING, *MOVEMENTS], default=MIXED
    )


def join_footsteps(parts: list[Footsteps]) -> Footsteps:
    """Return several collections as one; runs get numbers of their own.

    Args:
        parts: collections of footsteps of one controller, at least one.
    """
    offset, runs = 0, []
    for part in parts:
        numbers, index = np.unique(part.run, return_inverse=True)
        runs.append(index + offset)
        offset += len(numbers)
    joined = {
        each.name: np.concatenate([getattr(part, each.name) for part in parts]) for each in _ARRAYS
    }
    return Footsteps(**joined | {"run": np.concatenate(runs)})


def _require_consistent(footsteps: Footsteps, controller: ControllerIdentity) -> None:
    """Refuse arrays that are no footsteps of the controller.

    Raises:
        InputError: the message names the array, and what it would have to be.
    """
    count, feet = len(footsteps), len(controller.feet)
    for each in _ARRAYS:
        array = getattr(footsteps, each.name)
        shape = _shape(each.name, count, feet)
        if array.shape != shape:
            raise InputError(f"{each.name} has shape {array.shape}; {shape} is needed")
        kinds = "iu" if each.name in _WHOLE else "f"
        if array.dtype.kind not in kinds:
            needed = "whole" if kinds == "iu" else "floating-point"
            raise InputError(f"{each.name} holds {array.dtype}; {needed} numbers are needed")
        finite = np.isfinite(array)
        if not (finite.all() or each.name == "apex"):
            bad = int(np.argmin(finite.reshape(count, -1).all(axis=1)))
            raise InputError(f"{each.name} of footstep {bad} is not finite")
    outside = (footsteps.pair < 0) | (footsteps.pair >= len(controller.pairs))
    if outside.any():
        raise InputError(
            f"pair of footstep {int(np.argmax(outside))} is {footsteps.pair[np.argmax(outside)]};"
            f" controller {controller.name} has the pairs 0 to {len(controller.pairs) - 1}"
        )


def _shape(name: str, count: int, feet: int) -> tuple[int, ...]:
    """Return the shape that an array of `Footsteps` needs."""
    what = name.removesuffix("_before").removesuffix("_after")
    if what == "feet":
        return (count, feet, 3)
    return (count,) if what in _SIZES else (count, 3)
