"""Guide paths for the planner: one configuration in five, and the root's pose ahead."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.box_collision import Places, boxes_meet_ground
from jaxleas.contacts.sampling.candidates import Aim
from jaxleas.contacts.sampling.case import PlanningCase
from jaxleas.contacts.sampling.roots import Roots, rotations_to_world, to_model, to_world
from jaxleas.robots import Legs
from jaxleas.types import GuidePath, InputError

MOST_COORDINATE = 1e4  # a guide path further out is given in other units [m]


@dataclass(frozen=True, eq=False)
class KeptGuides:
    """The kept configurations of several guide paths, padded with the last of each.

    Attributes:
        index: index of each configuration in its guide path.
        length: number of configurations of each path.
        roots: position and yaw, `[B * T]` rows.
        ahead: root poses some time later, in the same rows.
        direction: unit vector of the motion in the world, zero at standstill, in the same rows.
        trunk_free: whether the trunk touches nothing.
        reference_sole: reference position of each foot, in the root frame, mirrored where its leg
            mirrors its model [m].
        side: side of each leg: -1 for the mirror image of its model, else +1.
    """

    index: Int[np.ndarray, "B T"]
    length: Int[np.ndarray, " B"]
    roots: Roots
    ahead: Roots
    direction: Float[np.ndarray, "rows 3"]
    trunk_free: Bool[np.ndarray, "B T"]
    reference_sole: Float[np.ndarray, "F 3"]
    side: Float[np.ndarray, " F"]

    def flat(self, guide: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Return the rows of configurations `at` of guide paths `guide`."""
        return guide * self.index.shape[1] + at

    def aim(self, guide: np.ndarray, at: np.ndarray, limb: np.ndarray) -> Aim:
        """Return the aim of a moving foot at a configuration."""
        rows = self.flat(guide, at)
        roots, ahead, side = self.roots[rows], self.ahead[rows], self.side[limb]
        target = to_world(self.reference_sole[limb], ahead.yaw, side) + ahead.position
        return Aim(
            roots,
            limb,
            to_model(target - roots.position, roots.yaw, side),
            to_model(self.direction[rows], roots.yaw, side),
        )


def keep_configurations(
    case: PlanningCase, guide_paths: Sequence[GuidePath], scene_index: Sequence[int]
) -> KeptGuides:
    """Keep every N-th configuration and the last, and judge the trunk at each.

    Args:
        case: robot, scene, settings.
        guide_paths: guide paths to keep, at least one, each of them usable.
        scene_index: index of the ground's scene that each path is in.
    """
    settings = case.settings
    kept = []
    for path in guide_paths:
        index = np.arange(0, len(path), settings.keep_every)
        kept.append(index if index[-1] == len(path) - 1 else np.append(index, len(path) - 1))
    length = np.array([len(index) for index in kept])
    widest = int(length.max())
    index = np.stack([np.pad(each, (0, widest - len(each)), mode="edge") for each in kept])
    position, yaw, later, later_yaw, direction = [], [], [], [], []
    for path, rows in zip(guide_paths, index, strict=True):
        turned = np.unwrap(np.asarray(path.yaw, dtype=np.float64))
        places = np.asarray(path.position, dtype=np.float64)
        time = np.asarray(path.time, dtype=np.float64)
        then = time[rows] + settings.look_ahead
        position.append(places[rows])
        yaw.append(turned[rows])
        later.append(np.stack([np.interp(then, time, places[:, k]) for k in range(3)], axis=1))
        later_yaw.append(np.interp(then, time, turned))
        ahead = places[np.minimum(rows + 1, len(path) - 1)] - places[np.maximum(rows - 1, 0)]
        speed = np.linalg.norm(ahead, axis=1, keepdims=True)
        direction.append(np.where(speed > 1e-6, ahead / np.maximum(speed, 1e-6), 0.0))
    scene = np.repeat(np.asarray(scene_index, dtype=np.int64), widest)
    roots = Roots(np.concatenate(position), np.concatenate(yaw), scene)
    return KeptGuides(
        index=index,
        length=length,
        roots=roots,
        ahead=Roots(np.concatenate(later), np.concatenate(later_yaw), scene),
        direction=np.concatenate(direction),
        trunk_free=trunk_is_free(case, roots).reshape(index.shape),
        reference_sole=_reference_soles(case.legs),
        side=case.legs.side,
    )


def _reference_soles(legs: Legs) -> Float[np.ndarray, "F 3"]:
    """Return the reference position of each foot as its leg's model has it [m]."""
    soles = [model.posture(model.reference).tip for model in legs.models]
    return np.array([soles[number] for number in legs.model_of])


def trunk_is_free(case: PlanningCase, roots: Roots) -> Bool[np.ndarray, " N"]:
    """Return at which root poses no box of the trunk touches the scene."""
    free = np.ones(len(roots), dtype=bool)
    ones = np.ones(len(roots))
    turn = rotations_to_world(np.broadcast_to(np.eye(3), (len(roots), 3, 3)), roots.yaw, ones)
    places = Places.of(roots.position, roots.scene, 1)
    for box in case.robot.trunk:
        low, high = np.asarray(box.low), np.asarray(box.high)
        middle = np.broadcast_to(0.5 * (low + high), (len(roots), 3))
        centre = to_world(middle, roots.yaw, ones) + roots.position
        half = np.broadcast_to(0.5 * (high - low), (len(roots), 3))
        free &= ~boxes_meet_ground(centre, turn, half, case.ground, places)
    return free


def require_usable(path: GuidePath, number: int) -> None:
    """Refuse a guide path that cannot be followed.

    Raises:
        InputError: says which path, and what is wrong with it.
    """
    rows = len(path.time)
    where = f"guide path {number}"
    if rows == 0:
        raise InputError(f"{where} has no configuration; it needs at least one")
    shapes = np.shape(path.position), np.shape(path.yaw)
    if shapes != ((rows, 3), (rows,)):
        raise InputError(
            f"{where}: position {shapes[0]} and yaw {shapes[1]} do not fit its {rows} times"
        )
    for name in ("time", "position", "yaw"):
        values = np.asarray(getattr(path, name))
        if not np.isfinite(values).all() or np.abs(values).max() > MOST_COORDINATE:
            raise InputError(
                f"{where}: {name} holds numbers that are not finite or beyond {MOST_COORDINATE:g}"
            )
    if (np.diff(path.time) < 0).any():
        raise InputError(f"{where}: time runs backwards; give configurations in order of time")
