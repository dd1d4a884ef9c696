"""Serial chains of revolute joints: forward kinematics and Jacobian, for many postures at once."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError, Pose

MOST_JOINTS = 100
_MIRROR = np.array([1.0, -1.0, 1.0])


@dataclass(frozen=True, eq=False)
class SerialChain:
    """Joints one after the other, from the root to an effector, as a URDF states them.

    Attributes:
        names: names of the joints.
        positions: origin of each joint's frame in the frame of the link before [m].
        rotations: orientation of each joint's frame in the frame of the link before, at angle 0.
        axes: unit axis that each joint turns about, in its own frame.
        lower: lower joint limits [rad].
        upper: upper joint limits [rad].
        tip: pose of the effector in the frame of the last link.

    Raises:
        InputError: shapes disagree, an axis is not of unit length, or limits are not intervals.
    """

    names: tuple[str, ...]
    positions: Float[np.ndarray, "J 3"]
    rotations: Float[np.ndarray, "J 3 3"]
    axes: Float[np.ndarray, "J 3"]
    lower: Float[np.ndarray, " J"]
    upper: Float[np.ndarray, " J"]
    tip: Pose

    def __post_init__(self) -> None:
        count = len(self.names)
        if not 1 <= count <= MOST_JOINTS:
            raise InputError(f"a chain of {count} joints; it needs 1 to {MOST_JOINTS}")
        shapes = {
            "positions": (count, 3),
            "rotations": (count, 3, 3),
            "axes": (count, 3),
            "lower": (count,),
            "upper": (count,),
        }
        for key, shape in shapes.items():
            array = getattr(self, key)
            if array.shape != shape or not np.isfinite(array).all():
                raise InputError(
                    f"a chain of {count} joints needs finite {key} of shape {shape}, not of shape"
                    f" {array.shape}"
                )
        with np.errstate(over="ignore"):  # untrusted files may hold numbers of any size
            length = np.linalg.norm(self.axes, axis=1)
        if np.abs(length - 1.0).max() > 1e-6:
            raise InputError("the axes of a chain's joints must have length 1")
        crossed = np.flatnonzero(self.lower > self.upper)
        if len(crossed):
            joint = int(crossed[0])
            raise InputError(
                f"joint '{self.names[joint]}': its lower limit {self.lower[joint]} is above its"
                f" upper limit {self.upper[joint]} [rad]"
            )

    def __len__(self) -> int:
        """Return the number of joints."""
        return len(self.names)

    @cached_property
    def turned(self) -> tuple[bool, ...]:
        """Whether each joint's frame is rotated relative to the previous link at angle 0."""
        return tuple(bool(np.any(each != np.eye(3))) for each in self.rotations)

    @cached_property
    def turned_tip(self) -> bool:
        """Whether the effector's frame is rotated relative to the last link."""
        return bool(np.any(self.tip.rotation != np.eye(3)))

    @cached_property
    def offsets(self) -> tuple[tuple[tuple[int, float], ...], ...]:
        """Nonzero coordinates of the positions of joints and tip, with their indices [m]."""
        places = [*self.positions, self.tip.position]
        return tuple(
            tuple((index, float(place[index])) for index in range(3) if place[index])
            for place in places
        )

    @cached_property
    def along(self) -> tuple[int | None, ...]:
        """Index of the coordinate axis that each joint turns about; None for other axes."""
        return tuple(
            int(axis.argmax()) if np.array_equal(axis, np.eye(3)[axis.argmax()]) else None
            for axis in self.axes
        )

    @cached_property
    def mirror_signs(self) -> Float[np.ndarray, " J"]:
        """Signs that turn this chain's angles into its mirror image's in the mirrored posture.

        A mirror turns the axis a, a pseudovector, into -S a with S = diag(1, -1, 1). Where that
        points backwards, the mirror image's joint turns about S a and counts the other way.
        """
        return np.where((-self.axes * _MIRROR * self.axes).sum(axis=1) < 0.0, -1.0, 1.0)

    def mirrored(self) -> "SerialChain":
        """Return the mirror image in the plane y = 0: a right limb's chain from the left one's."""
        signs, both = self.mirror_signs, np.outer(_MIRROR, _MIRROR)
        backwards = signs < 0.0
        return SerialChain(
            self.names,
            self.positions * _MIRROR + 0.0,
            self.rotations * both + 0.0,
            -signs[:, None] * self.axes * _MIRROR + 0.0,
            np.where(backwards, -self.upper, self.lower) + 0.0,
            np.where(backwards, -self.lower, self.upper) + 0.0,
            Pose.from_matrix(self.tip.position * _MIRROR, self.tip.rotation * both),
        )


@dataclass(frozen=True, eq=False)
class ChainPosture:
    """The poses of a chain's links in the root frame.

    Attributes:
        frames: orientation of each link, turned by its joint.
        origins: position of each joint [m].
        tip: position of the effector [m].
        tip_rotation: orientation of the effector.
    """

    frames: Float[np.ndarray, "*batch J 3 3"]
    origins: Float[np.ndarray, "*batch J 3"]
    tip: Float[np.ndarray, "*batch 3"]
    tip_rotation: Float[np.ndarray, "*batch 3 3"]


def chain_posture(chain: SerialChain, angles: Float[np.ndarray, "*batch J"]) -> ChainPosture:
    """Return the posture of a chain in the root frame.

    Args:
        chain: chain of joints.
        angles: joint angles [rad].
    """
    batch, count = angles.shape[:-1], len(chain)
    cosines, sines = np.cos(angles)[..., None], np.sin(angles)[..., None]
    frames, origins = np.empty((*batch, count, 3, 3)), np.empty((*batch, count, 3))
    before = np.broadcast_to(np.eye(3), (*batch, 3, 3))
    place = np.zeros((*batch, 3))
    for joint in range(count):
        place = _moved(place, before, chain.offsets[joint])
        origins[..., joint, :] = place
        if chain.turned[joint]:
            before = before @ chain.rotations[joint]
        frame = frames[..., joint, :, :]
        _turn(before, chain, joint, cosines[..., joint, :], sines[..., joint, :], frame)
        before = frame
    tip = _moved(place, before, chain.offsets[-1])
    return ChainPosture(
        frames, origins, tip, before @ chain.tip.rotation if chain.turned_tip else before
    )


def chain_jacobian(chain: SerialChain, posture: ChainPosture) -> Float[np.ndarray, "*batch 6 J"]:
    """Return the effector's velocity over its turn rate for each joint's speed [m and 1].

    Column j is (a_j x (tip - o_j); a_j) for the joint's axis a_j through o_j.
    """
    axes = np.empty(posture.origins.shape)
    for joint, along in enumerate(chain.along):
        frame = posture.frames[..., joint, :, :]
        axes[..., joint, :] = frame @ chain.axes[joint] if along is None else frame[..., along]
    x, y, z = (axes[..., index] for index in range(3))
    arms = posture.tip[..., None, :] - posture.origins
    u, v, w = (arms[..., index] for index in range(3))
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u, x, y, z], axis=-2)


def _moved(
    place: np.ndarray, frame: np.ndarray, offset: tuple[tuple[int, float], ...]
) -> np.ndarray:
    for index, length in offset:
        place = place + length * frame[..., index]
    return place


def _turn(
    before: np.ndarray,
    chain: SerialChain,
    joint: int,
    cosine: np.ndarray,
    sine: np.ndarray,
    out: np.ndarray,
) -> None:
    """Write `before` times the joint's rotation into `out`."""
    along = chain.along[joint]
    if along is not None:  # two columns mix, the third does not change
        first, second = (along + 1) % 3, (along + 2) % 3
        out[..., along] = before[..., along]
        out[..., first] = cosine * before[..., first] + sine * before[..., second]
        out[..., second] = cosine * before[..., second] - sine * before[..., first]
        return
    x, y, z = chain.axes[joint]
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # Rodrigues: I + sin(a) [axis] + (1 - cos(a)) [axis]^2
    about = np.eye(3) + sine[..., None] * cross + (1.0 - cosine[..., None]) * (cross @ cross)
    out[...] = before @ about
