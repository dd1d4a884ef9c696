"""Where the feet of a URDF touch: as is stated, else as the shapes of their links say."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from jaxleas.modelling.legs import FEW_JOINTS
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.soles import FootShape, foot_shape, snapped
from jaxleas.modelling.tree import UrdfTree
from jaxleas.robots import SerialChain, chain_between, chain_posture
from jaxleas.types import InputError, Pose

Say = Callable[[str], None]
_MOVED_BY = 0.005
"""Distance above which the frame of a foot counts as not at its sole [m]."""
_SURE = 0.02
"""Distance by which a stated sole may differ from what the shapes say, each way [m]."""
_UNSURE = 0.04
"""Likewise where the shape is a box of inertia [m]."""
_NARROW = 0.01
"""Half width below which what touches is a point [m]."""


@dataclass(frozen=True, eq=False)
class Foot:
    """A foot whose sole is known, before its leg stands.

    Attributes:
        link: link or frame of the URDF that was named.
        whole: joints from the root to the middle of the sole, with the URDF's limits.
        chain: the same with the limits that are stated.
        flat: whether it stands with a sole.
        half_size: half length and half width of the sole [m]; zeros for a point foot.
        neutral: middle of the sole in the root frame, all joints at 0 [m].
        moved: where the sole is, as a clause, if it is not at the frame; else "".
        stated: angles of a reference stance that is stated [rad]; None without one.
    """

    link: str
    whole: SerialChain
    chain: SerialChain
    flat: bool
    half_size: tuple[float, float]
    neutral: Float[np.ndarray, " 3"]
    moved: str
    stated: Float[np.ndarray, " J"] | None

    @classmethod
    def found(
        cls,
        tree: UrdfTree,
        ends: tuple[str, str],
        options: MakeOptions,
        postures: tuple[Mapping[str, float], Mapping[str, float]],
    ) -> "Foot":
        """Return the foot of a link.

        Args:
            tree: links of the robot.
            ends: names of the root and of the foot's link.
            options: choices for the robot.
            postures: angles of all joints in the reference stance, as far as stated, and those of
                joints that do not move.

        Raises:
            InputError: says which choice is missing or contradicts the URDF.
        """
        (_, link), (angles, held) = ends, postures
        _require_no_mimics(tree, ends)
        chain = chain_between(tree.path, tree.joints, ends, None, held)
        flat = options.kind != "point_foot" and (options.kind == "foot" or len(chain) > FEW_JOINTS)
        stated = None
        if any(name in options.reference for name in chain.names):
            stated = np.array([angles[name] for name in chain.names])
            _require_within(_limited(chain, options), stated)
        zero = chain_posture(chain, np.zeros(len(chain)))
        seen_at = stated if stated is not None else np.zeros(len(chain))
        axes = _axes(chain, zero.tip_rotation, stated, flat)
        shape = foot_shape(tree, link, axes)
        half = options.half_size or (shape.half_size if shape and not shape.guessed else None)
        if options.kind is None and options.half_size is None and half is not None:
            flat = flat and min(half) >= _NARROW
        if not flat:
            axes = chain_posture(chain, seen_at).tip_rotation.T
            shape = foot_shape(tree, link, axes)
        elif half is None or min(half) < _NARROW:
            raise InputError(
                f"no shape says how large the sole of '{link}' is: state half_size, its half length"
                " and half width in metres (or kind: point_foot)"
            )
        left = 1.0 if zero.tip[1] >= 0.0 else -1.0
        sole = _sole(link, options, shape, axes, (left, flat))
        frame = Pose.from_matrix(sole, axes if flat else np.eye(3))
        whole = replace(chain, tip=chain.tip @ frame)
        chain = _limited(whole, options)
        neutral = chain_posture(chain, np.zeros(len(chain))).tip
        size = (0.0, 0.0) if not flat or half is None else half
        size = (round(size[0], 4), round(size[1], 4))
        return cls(link, whole, chain, flat, size, neutral, _moved(sole, options), stated)


def _require_no_mimics(tree: UrdfTree, ends: tuple[str, str]) -> None:
    for joint in tree.path_to(ends[1], ends[0]):
        if joint.mimics:
            raise InputError(
                f"{tree.path}: joint '{joint.name}' of the leg of '{ends[1]}' mimics another one;"
                " joints of a leg must move by themselves"
            )


def _limited(chain: SerialChain, options: MakeOptions) -> SerialChain:
    """Return a chain with the limits that are stated; none is wider than a turn."""
    whole_turn = chain.upper - chain.lower > 2.0 * np.pi
    lower = np.where(whole_turn, np.maximum(chain.lower, -np.pi), chain.lower)
    upper = np.where(whole_turn, np.minimum(chain.upper, np.pi), chain.upper)
    for index, name in enumerate(chain.names):
        if name in options.limits:
            low, high = options.limits[name]
            lower[index], upper[index] = max(lower[index], low), min(upper[index], high)
    return replace(chain, lower=np.round(lower, 6), upper=np.round(upper, 6))


def _require_within(chain: SerialChain, angles: np.ndarray) -> None:
    outside = np.flatnonzero((angles < chain.lower - 1e-3) | (angles > chain.upper + 1e-3))
    if len(outside):
        index = int(outside[0])
        raise InputError(
            f"reference states {angles[index]:g} rad for joint '{chain.names[index]}', whose limits"
            f" are {chain.lower[index]:g} and {chain.upper[index]:g}"
        )


def _axes(
    chain: SerialChain, zero: np.ndarray, stated: np.ndarray | None, flat: bool
) -> np.ndarray:
    """Return the axes of a level sole in the frame of its link, as columns."""
    near = snapped(zero)
    if near is None and flat and stated is not None:
        return chain_posture(chain, stated).tip_rotation.T
    return np.eye(3) if near is None else near.T


def _sole(
    link: str,
    options: MakeOptions,
    shape: FootShape | None,
    axes: np.ndarray,
    kind: tuple[float, bool],
) -> Float[np.ndarray, " 3"]:
    """Return the middle of a sole in the frame of its link [m]; checks what is stated."""
    left, flat = kind
    if options.sole is not None:
        x, y, z = options.sole
        first = 1.0 if options.feet[0] == link else left
        sole = np.array([x, y * first, z])
        if shape is not None and not shape.guessed:
            off = float((sole @ axes)[2]) - shape.lowest
            if abs(off) > _SURE:
                raise InputError(
                    f"the stated sole of '{link}' is {abs(off):.3f} m"
                    f" {'above' if off > 0 else 'below'} the lowest point of the foot in the"
                    f" reference stance; it would be at {_text(shape.middle)} m in the link's frame"
                )
        return sole
    if shape is None:
        return np.zeros(3)
    if shape.guessed:
        if abs(shape.lowest) > _UNSURE:
            raise InputError(
                f"the frame of '{link}' is not at its sole: by its inertia the foot ends about"
                f" {abs(shape.lowest):.2f} m {'below' if shape.lowest < 0 else 'above'} it in the"
                " reference stance, and its meshes are not at hand: state the sole, --sole X Y Z"
            )
        return np.zeros(3)
    off = -shape.lowest
    if abs(off) <= _MOVED_BY and (not flat or np.hypot(*(shape.middle @ axes)[:2]) <= _MOVED_BY):
        return np.zeros(3)
    return np.round(shape.middle, 4) + 0.0


def _moved(sole: np.ndarray, options: MakeOptions) -> str:
    """Return where a sole was found to be, as a clause; empty where its frame is."""
    if options.sole is not None or not sole.any():
        return ""
    return (
        f"{np.linalg.norm(sole):.3f} m from the sole, which is taken at {_text(sole)} m in that"
        " frame, as the shapes say (--sole states another)"
    )


def _text(place: np.ndarray) -> str:
    return "(" + ", ".join(f"{each:g}" for each in np.round(place, 4) + 0.0) + ")"
