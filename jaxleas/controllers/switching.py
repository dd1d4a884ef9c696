"""Several controllers of one robot, of which each robot has one at a time."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.controllers.controller import Controller, JointCommand
from jaxleas.physics import BodyState, Sensed
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class SwitchingMemory:
    """What several controllers remember of N robots.

    Attributes:
        chosen: index of each robot's controller.
        memories: memory of each controller, of all robots; a robot's part counts while it has it.
    """

    chosen: Int[np.ndarray, " N"]
    memories: tuple[Any, ...]


class Switching:
    """Controllers that take turns; each robot begins with the first.

    A controller that takes over begins as it does with a robot that stands. All feet of the robot
    must stand then, and the pair that swings next must be the one that the controller begins with.

    Args:
        controllers: controllers of one robot with the same feet, pairs, largest speeds and period.

    Attributes:
        identity: identity of the first controller, with the names of all.
        period: time between two decisions [s].

    Raises:
        InputError: they cannot take turns.
    """

    def __init__(self, controllers: Sequence[Controller]) -> None:
        self.controllers = tuple(controllers)
        first = self.controllers[0]
        for other in self.controllers[1:]:
            for what in ("robot", "feet", "pairs", "max_speeds"):
                mine, others = getattr(first.identity, what), getattr(other.identity, what)
                if mine != others:
                    raise InputError(
                        f"controllers {first.identity.name} and {other.identity.name} cannot take"
                        f" turns: {what} is {mine} of the one and {others} of the other"
                    )
            if other.period != first.period:
                raise InputError(
                    f"controllers {first.identity.name} and {other.identity.name} cannot take"
                    f" turns: they decide every {first.period:g} and {other.period:g} s"
                )
        names = " or ".join(each.identity.name for each in self.controllers)
        self.identity = replace(first.identity, name=names, settings={})
        self.period = first.period

    def start(self, state: BodyState) -> SwitchingMemory:
        """Return the memory of robots that stand at rest."""
        memories = tuple(each.start(state) for each in self.controllers)
        return SwitchingMemory(np.zeros(len(state), dtype=np.int64), memories)

    def act(
        self,
        memory: SwitchingMemory,
        state: BodyState,
        sensed: Sensed,
        command: Float[np.ndarray, "N 3"],
    ) -> tuple[SwitchingMemory, JointCommand]:
        """Return the next memory, and what the joints of each robot are to do."""
        memories, wanted = list(memory.memories), None
        for index in np.unique(memory.chosen).tolist():
            controller = self.controllers[index]
            memories[index], joints = controller.act(memories[index], state, sensed, command)
            its = memory.chosen == index
            wanted = joints if wanted is None else _merged_joints(its, joints, wanted)
        if wanted is None:
            raise InputError("no robot is to be walked")
        return replace(memory, memories=tuple(memories)), wanted

    def switched(
        self, memory: SwitchingMemory, state: BodyState, chosen: Int[np.ndarray, " N"]
    ) -> SwitchingMemory:
        """Return the memory after robots got other controllers, which begin anew.

        Args:
            memory: memory until now.
            state: state now.
            chosen: index of each robot's controller from now on.
        """
        memories = list(memory.memories)
        for index, controller in enumerate(self.controllers):
            begins = (chosen == index) & (memory.chosen != index)
            if begins.any():
                memories[index] = merged(begins, controller.start(state), memories[index])
        return SwitchingMemory(np.array(chosen), tuple(memories))


def merged(where: Bool[np.ndarray, " N"], new: Any, old: Any) -> Any:
    """Return a controller's memory with that of some robots replaced.

    Args:
        where: whose memory is replaced.
        new: dataclass or tuple of arrays whose first axis counts the robots.
        old: the same before.
    """
    if is_dataclass(old) and not isinstance(old, type):
        parts = {
            each.name: merged(where, getattr(new, each.name), getattr(old, each.name))
            for each in fields(old)
        }
        return type(old)(**parts)
    if isinstance(old, tuple):
        return tuple(merged(where, *each) for each in zip(new, old, strict=True))
    array = np.asarray(old)
    return np.where(where.reshape(-1, *[1] * (array.ndim - 1)), new, array)


def _merged_joints(
    where: Bool[np.ndarray, " N"], new: JointCommand, old: JointCommand
) -> JointCommand:
    """Return joint commands with those of some robots replaced; springs become each robot's own."""
    rows = where[:, None]
    return JointCommand(
        *(
            np.where(rows, getattr(new, each.name), getattr(old, each.name))
            for each in fields(JointCommand)
        )
    )
