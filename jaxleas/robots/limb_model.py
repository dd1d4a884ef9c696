"""Kinematics and masses of limbs, for planners that move their joints."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.geometry import Box, Polytope
from jaxleas.robots.chain import ChainPosture, SerialChain, chain_posture
from jaxleas.robots.numeric_inverse import draw_starts, newton_inverse, numeric_inverse
from jaxleas.robots.spherical_leg import SphericalLeg
from jaxleas.types import InputError

_MIRROR = np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True)
class LinkBox:
    """A box around a link.

    Attributes:
        link: index of the link in its chain, from 0.
        box: box in the frame of the link [m].
    """

    link: int
    box: Box


@dataclass(frozen=True)
class Capsule:
    """All points near a line segment of a link.

    Attributes:
        link: index of the link in its chain, from 0.
        start: one end of the segment in the frame of the link [m].
        end: its other end [m].
        radius: distance within which points belong to the capsule [m].
    """

    link: int
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float


@dataclass(frozen=True, eq=False)
class LimbModel:
    """Kinematics, masses and shapes of one limb.

    Attributes:
        chain: joints from the root to the effector.
        reference: joint angles of the reference configuration [rad].
        link_mass: mass of each link [kg].
        link_com: centre of mass of each link in its frame [m].
        boxes: boxes that must touch nothing; those of the last link are the effector's.
        capsules: capsules that must not touch those of other limbs.
        com_reach: reach of the centre of mass of the whole robot while the effector stands, in the
            effector's frame rotated only by its yaw [m].
        starts: postures from which searches for an inverse start [rad]; None to draw them.

    Raises:
        InputError: shapes disagree, or a mass is negative.
    """

    chain: SerialChain
    reference: Float[np.ndarray, " J"]
    link_mass: Float[np.ndarray, " J"]
    link_com: Float[np.ndarray, "J 3"]
    boxes: tuple[LinkBox, ...]
    capsules: tuple[Capsule, ...]
    com_reach: Polytope
    starts: Float[np.ndarray, "S J"] | None = None

    def __post_init__(self) -> None:
        count = len(self.chain)
        for key, shape in (("reference", (count,)), ("link_mass", (count,)),
                           ("link_com", (count, 3))):  # fmt: skip
            array = getattr(self, key)
            if array.shape != shape or not np.isfinite(array).all():
                raise InputError(
                    f"a limb of {count} joints needs finite {key} of shape {shape}, not of shape"
                    f" {array.shape}"
                )
        if (self.link_mass < 0.0).any():
            raise InputError("the masses of a limb's links must not be negative")
        for each in (*self.boxes, *self.capsules):
            if not 0 <= each.link < count:
                raise InputError(f"a limb of {count} joints has no link {each.link} (from 0)")

    def posture(self, angles: Float[np.ndarray, "*batch J"]) -> ChainPosture:
        """Return the posture of the limb in the root frame.

        Args:
            angles: joint angles [rad].
        """
        return chain_posture(self.chain, angles)

    def inverse(
        self,
        position: Float[np.ndarray, "*batch 3"],
        rotation: Float[np.ndarray, "*batch 3 3"],
        start: Float[np.ndarray, "*batch J"] | None = None,
    ) -> tuple[Float[np.ndarray, "*batch J"], Bool[np.ndarray, "*batch"]]:
        """Return joint angles that bring the effector to a pose.

        The solution has a closed form for a leg with a spherical hip; for other chains a search
        finds it, and may miss it; chains of fewer than six joints only reach the position.

        Args:
            position: position of the effector in the root frame [m].
            rotation: orientation of the effector in the root frame.
            start: posture near each pose, if known; a search then starts only from it [rad].

        Returns:
            The angles [rad], and whether the pose is in reach within the joint limits.
        """
        if self._spherical is not None:
            angles, in_reach = self._spherical.inverse(position, rotation)
            within = ((angles >= self.chain.lower) & (angles <= self.chain.upper)).all(axis=-1)
            return angles, in_reach & within
        batch, count = position.shape[:-1], len(self.chain)
        flat = position.reshape(-1, 3)
        turn = rotation.reshape(-1, 3, 3) if count >= 6 else None
        if start is None:
            angles, reached = numeric_inverse(self.chain, self._starts, flat, turn)
        else:
            angles, reached = newton_inverse(self.chain, start.reshape(-1, count), flat, turn)
        return angles.reshape(*batch, count), reached.reshape(batch)

    def mass_moment(
        self, frames: Float[np.ndarray, "*batch J 3 3"], origins: Float[np.ndarray, "*batch J 3"]
    ) -> Float[np.ndarray, "*batch 3"]:
        """Return the sum of mass times centre over the links, in their frame [kg m].

        Args:
            frames: orientation of each link.
            origins: origin of each link [m].
        """
        centres = (frames @ self.link_com[:, :, None])[..., 0] + origins
        return (self.link_mass[:, None] * centres).sum(axis=-2)

    def mirrored(self) -> "LimbModel":
        """Return the mirror image in the plane y = 0: the right limb from the left one."""
        return replace(
            self,
            chain=self.chain.mirrored(),
            reference=self.reference * self.chain.mirror_signs + 0.0,
            link_com=self.link_com * _MIRROR,
            boxes=tuple(replace(each, box=_mirrored_box(each.box)) for each in self.boxes),
            capsules=tuple(
                replace(each, start=_mirrored(each.start), end=_mirrored(each.end))
                for each in self.capsules
            ),
            com_reach=self.com_reach.mirrored(),
            # Limbs that are mirror images must find mirror images.
            starts=self._starts * self.chain.mirror_signs,
        )

    @cached_property
    def _spherical(self) -> SphericalLeg | None:
        return SphericalLeg.of(self.chain)

    @cached_property
    def _starts(self) -> Float[np.ndarray, "S J"]:
        return draw_starts(self.chain, self.reference) if self.starts is None else self.starts


@dataclass(frozen=True, eq=False)
class Body:
    """The part of a robot that is not a limb.

    Attributes:
        mass: mass of the body [kg].
        com: centre of mass in the root frame, joints in the reference configuration [m].
    """

    mass: float
    com: Float[np.ndarray, " 3"]


def _mirrored(point: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = point
    return (x, -y, z)


def _mirrored_box(box: Box) -> Box:
    (x, y, z), (u, v, w) = box.low, box.high
    return Box((x, -v, z), (u, -y, w))
