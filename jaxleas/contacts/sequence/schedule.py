"""A contact sequence at even times: who touches, and where each effector is."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sequence.values import ContactSequence
from jaxleas.types import Contact, InputError, Pose

MOST_NODES = 1_000_000
CORNERS = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
"""Corners of a sole in half sizes: front left, front right, rear left, rear right."""


@dataclass(frozen=True, eq=False)
class Schedule:
    """Contacts and poses of effectors at even times.

    Attributes:
        time: times since the start [s].
        contact: whether each effector touches.
        position: position of each effector in the world [m]; NaN before its first contact.
        quaternion: orientation of each effector (w, x, y, z).
    """

    time: Float[np.ndarray, " N"]
    contact: Bool[np.ndarray, "N E"]
    position: Float[np.ndarray, "N E 3"]
    quaternion: Float[np.ndarray, "N E 4"]

    def corners(self, half_sizes: Float[np.ndarray, "E 2"]) -> Float[np.ndarray, "N E 4 3"]:
        """Return the positions of the soles' corners in the world [m], in the order `CORNERS`."""
        offsets = np.zeros((len(half_sizes), 4, 3))
        offsets[..., :2] = CORNERS * half_sizes[:, None]
        pose = Pose(np.nan_to_num(self.position), self.quaternion)
        offsets = np.broadcast_to(offsets, (*self.contact.shape, 4, 3))
        return np.where(np.isnan(self.position)[..., None, :], np.nan, pose.transform(offsets))


def schedule_of(sequence: ContactSequence, interval: float, height: float) -> Schedule:
    """Sample a contact sequence, the last time at its end or just before it.

    Between contacts an effector moves along a smooth curve, at rest at both ends. Half way it is
    `height` above the higher of both contacts, measured along their mean normal.

    Args:
        sequence: sequence to sample.
        interval: time between nodes [s].
        height: height of swings [m].

    Raises:
        InputError: the interval is no time, there would be too many nodes, or the height is
            negative.
    """
    if not (np.isfinite(interval) and interval > 0.0):
        raise InputError(f"--interval {interval:g} must be a positive number of seconds")
    if not (np.isfinite(height) and height >= 0.0):
        raise InputError(f"--step-height {height:g} must be a length, in metres")
    nodes = int(sequence.duration / interval + 1e-9) + 1
    if nodes > MOST_NODES:
        raise InputError(f"--interval {interval:g} makes {nodes} nodes, more than {MOST_NODES}")
    time = interval * np.arange(nodes)
    names = sequence.effectors
    made = Schedule(
        time,
        np.zeros((nodes, len(names)), bool),
        np.full((nodes, len(names), 3), np.nan),
        np.tile([1.0, 0.0, 0.0, 0.0], (nodes, len(names), 1)),
    )
    for at, name in enumerate(names):
        if name in sequence.initial:
            _stand(made, at, sequence.initial[name], time >= 0.0)
    latest = dict(sequence.initial.contacts)
    for landing, lift_off in zip(sequence.landings, sequence.lift_offs, strict=True):
        contact = landing.contact
        at = names.index(contact.effector)
        before = latest.get(contact.effector)
        if before is not None:
            moving = (time > lift_off + 1e-9) & (time < landing.time - 1e-9)
            share = (time[moving] - lift_off) / (landing.time - lift_off)
            made.contact[moving, at] = False
            made.position[moving, at], made.quaternion[moving, at] = _swing(
                before.pose, contact.pose, share, height
            )
        _stand(made, at, contact, time >= landing.time - 1e-9)
        latest[contact.effector] = contact
    return made


def _stand(made: Schedule, at: int, contact: Contact, when: Bool[np.ndarray, " N"]) -> None:
    made.contact[when, at] = True
    made.position[when, at] = contact.pose.position
    made.quaternion[when, at] = contact.pose.quaternion


def _swing(
    start: Pose, end: Pose, share: Float[np.ndarray, " M"], height: float
) -> tuple[Float[np.ndarray, "M 3"], Float[np.ndarray, "M 4"]]:
    """Return positions and orientations after shares of a swing, 0 to 1."""
    smooth = (share**3 * (10.0 - 15.0 * share + 6.0 * share**2))[:, None]
    normal = start.rotation[:, 2] + end.rotation[:, 2]
    length = float(np.linalg.norm(normal))
    normal = normal / length if length > 1e-6 else start.rotation[:, 2]
    way = end.position - start.position
    bump = (height + 0.5 * abs(float(way @ normal))) * 16.0 * (share * (1.0 - share)) ** 2
    position = start.position + smooth * way + bump[:, None] * normal
    one, two = start.quaternion, end.quaternion
    two = two if one @ two >= 0.0 else -two
    mixed = (1.0 - smooth) * one + smooth * two
    return position, mixed / np.linalg.norm(mixed, axis=1, keepdims=True)
