"""The move of one foot of each robot."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from jaxleas.contacts.sampling.candidates import Aim
from jaxleas.contacts.sampling.stance import Stances


@dataclass(frozen=True)
class Move:
    """A move of one foot of each robot, one row per robot.

    Attributes:
        aim: moving legs, and the poses of the roots when their feet land.
        stances: stances before the move; the contacts of the other feet are kept.
        order: value for `since` of the new contacts.
        least: distance by which the contact must move [m].
        lifted: whether the foot leaves a contact; a foot that is put down at the start does not.
    """

    aim: Aim
    stances: Stances
    order: Int[np.ndarray, " N"]
    least: float = 0.0
    lifted: bool = True
