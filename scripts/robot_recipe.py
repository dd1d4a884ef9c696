"""What a biped's file is made from: a published URDF, and the choices that no URDF states."""

import site
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  # its wheel adds a .pth

from jaxleas.geometry import Box
from jaxleas.robots import Capsule, LinkBox, SerialChain, read_chain
from jaxleas.types import Pose

SHARE = "cmeel.prefix/share/example-robot-data/robots"


@dataclass(frozen=True)
class Shapes:
    """Boxes and capsules of the left leg, each in the frame of its link."""

    boxes: tuple[LinkBox, ...]
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True)
class Recipe:
    """The choices for one biped whose right leg is the mirror image of its left one.

    Attributes:
        name: name of the robot.
        title: the robot as a sentence names it.
        urdf: path of the URDF among the robots of `example-robot-data`.
        root: name of the root's link.
        feet: names of the left and of the right foot's link.
        sole: middle of the left sole in the frame of its link [m]; the foot is level at angle 0.
        half_size: half length and half width of the sole [m].
        friction: friction coefficient mu [1].
        trunk: boxes around the body without its legs, in the root frame [m].
        root_height: height of the root in the reference configuration [m].
        walking_height: height of the root along guide paths [m].
        start_heights: lowest and highest start of an episode, above the walking height [m].
        reference_sole: middle of the left sole in the root frame, in the reference configuration
            [m].
        reference: returns the joint angles of the left leg in the reference configuration [rad].
        shapes: returns boxes and capsules of the left leg, given the folder of the robot.
        whole: returns the reference configuration of the whole robot, as Pinocchio counts it.
        reach: largest |x| and y of the middle of the left sole [m].
        step: longest step forwards or backwards, and least distance sideways of the soles [m].
        contact_window: how far ahead and to a side the contacts of the next stretch may lie [m].
        limits: limits of joints that are narrower than the URDF's, by index [rad].
        knee: index of the knee among the leg's joints.
        digits: number of decimals that limits, masses and centres of mass keep.
    """

    name: str
    title: str
    urdf: str
    root: str
    feet: tuple[str, str]
    sole: tuple[float, float, float]
    half_size: tuple[float, float]
    friction: float
    trunk: tuple[Box, ...]
    root_height: float
    walking_height: float
    start_heights: tuple[float, float]
    reference_sole: tuple[float, float, float]
    reference: Callable[["Recipe"], np.ndarray]
    shapes: Callable[[Path], Shapes]
    whole: Callable[["Recipe"], np.ndarray]
    reach: tuple[float, float]
    step: tuple[float, float]
    contact_window: tuple[float, float] = (0.65, 0.45)
    limits: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    knee: int = 3
    digits: int = 6

    @cached_property
    def path(self) -> Path:
        """Path of the URDF in the installed wheel, which holds data files only."""
        found = [Path(folder) / SHARE / self.urdf for folder in site.getsitepackages()]
        found = [path for path in found if path.is_file()]
        if not found:
            raise SystemExit(f"{self.urdf} is not installed: pip install example-robot-data pin")
        return found[0]

    @cached_property
    def model(self) -> pin.Model:
        """Pinocchio's model, for masses and for checks."""
        return pin.buildModelFromUrdf(str(self.path))

    @cached_property
    def chain(self) -> SerialChain:
        """The left leg's joints, down to the middle of its sole."""
        chain = read_chain(self.path, self.root, self.feet[0], self.frame)
        lower, upper = chain.lower.copy(), chain.upper.copy()
        for joint, (low, high) in self.limits.items():
            lower[joint], upper[joint] = max(lower[joint], low), min(upper[joint], high)
        return replace(chain, lower=lower, upper=upper)

    @property
    def frame(self) -> Pose:
        """Pose of the left sole in the frame of its link."""
        return Pose.from_yaw(np.array(self.sole), 0.0)

    @property
    def trunk_bottom(self) -> float:
        """Lowest point of the trunk below the root [m]."""
        return min(box.low[2] for box in self.trunk)

    def columns(self, chain: SerialChain) -> list[int]:
        """Return where Pinocchio keeps the angles of a chain's joints."""
        return [self.model.joints[self.model.getJointId(name)].idx_q for name in chain.names]
