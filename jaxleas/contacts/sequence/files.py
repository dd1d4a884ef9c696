"""Contact sequences as files: footsteps (.csv), phases (.json), and a schedule of nodes (.npz)."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.sequence.schedule import Schedule, schedule_of
from jaxleas.contacts.sequence.values import ContactSequence
from jaxleas.files import write_json, write_npz, write_text
from jaxleas.robots import Effector
from jaxleas.types import Contact, GuidePath, InputError, Pose

VERSION = 1
COLUMNS = (
    *("x", "y", "yaw", "z", "effector", "step", "time", "surface"),
    *("qw", "qx", "qy", "qz"),
)
SUFFIXES = (".csv", ".json", ".npz")


@dataclass(frozen=True)
class Sampling:
    """How a schedule is sampled.

    Attributes:
        interval: time between the nodes of a schedule (.npz) [s].
        step_height: height of swings in a schedule (.npz), above the higher of both contacts [m].
    """

    interval: float = 0.02
    step_height: float = 0.1


def require_sequence_name(out: Path) -> None:
    """Refuse names of files that contact sequences are not written as."""
    if out.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"--out {out}: contacts are written as footsteps (.csv), phases (.json) or a schedule"
            " of nodes (.npz)"
        )


def write_footsteps(path: Path, sequence: ContactSequence) -> str:
    """Write a row for each contact: those before the first step, then each step; return what."""
    rows = [(contact, 0, 0.0) for contact in sequence.initial.contacts.values()]
    rows += [(each.contact, number, each.time) for number, each in enumerate(sequence.landings, 1)]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for contact, step, time in rows:
        x, y, z = (_short(each) for each in contact.pose.position)
        place = x, y, _short(contact.pose.yaw), z
        turn = [round(each, 9) + 0.0 for each in contact.pose.quaternion.tolist()]
        table.writerow([*place, contact.effector, step, _short(time), contact.surface, *turn])
    write_text(path, text.getvalue())
    return f"{len(sequence.landings)} footsteps after {len(sequence.initial)} rows of step 0"


def write_phases(path: Path, sequence: ContactSequence) -> str:
    """Write phases with active contacts, poses, times and the contact that ends them; return what.

    See docs/contacts.md for the keys.
    """
    phases: list[dict[str, Any]] = []
    time = 0.0
    for number, phase in enumerate(sequence.phases):
        moves = number % 2 == 1
        landing = sequence.landings[number // 2].contact if moves else None
        phases.append(
            {
                "start": time,
                "duration": phase.duration,
                "contacts": {name: _contact(each) for name, each in phase.stance.contacts.items()},
                "landing": landing and {"effector": landing.effector, **_contact(landing)},
            }
        )
        time += phase.duration
    write_json(
        path,
        {
            "version": VERSION,
            "robot": sequence.robot,
            "effectors": {
                name: {"half_size": list(size), **_described(sequence.described.get(name))}
                for name, size in sequence.half_sizes.items()
            },
            "switch_times": [each["start"] for each in phases[1:]],
            "phases": phases,
        },
    )
    return f"{len(phases)} phases of {time:.2f} s in all"


def write_schedule(
    path: Path, sequence: ContactSequence, sampling: Sampling, root: GuidePath | None
) -> str:
    """Write contacts and positions at even times as arrays; return what.

    Args:
        path: path of the .npz file.
        sequence: contacts in time.
        sampling: how it is sampled.
        root: root of the robot, in the time of the sequence; None: the file holds no root.
    """
    found = schedule_of(sequence, sampling.interval, sampling.step_height)
    nodes, count = found.contact.shape
    half_sizes = np.array(list(sequence.half_sizes.values()))
    touch = found.contact.astype(np.float32)
    arrays = {
        "version": np.array(VERSION),
        "time": found.time,
        "effectors": np.array(sequence.effectors, np.str_),
        "half_sizes": half_sizes,
        "contact_sequence": touch,
        "foot_ref": found.position.reshape(nodes, 3 * count),
        "quaternion": found.quaternion,
        "corner_contact_sequence": np.repeat(touch, 4, axis=1),
        "corner_foot_ref": found.corners(half_sizes).reshape(nodes, 12 * count),
    }
    write_npz(path, **arrays, **({} if root is None else _root(found, root)))
    return f"{nodes} nodes of {sampling.interval:g} s for {count} effectors"


def _root(found: Schedule, root: GuidePath) -> dict[str, Float[np.ndarray, "N _"]]:
    """Return positions and upright orientations of the root at the nodes of a schedule."""
    yaw = np.interp(found.time, root.time, np.unwrap(root.yaw))
    position = np.stack(
        [np.interp(found.time, root.time, root.position[:, axis]) for axis in range(3)], axis=1
    )
    return {"p_ref": position, "quat_ref": Pose.from_yaw(position, yaw).quaternion}


def _short(number: object) -> float:
    """Return a number to a micrometre or microsecond, without a minus before zero."""
    return round(float(np.asarray(number)), 6) + 0.0


def _contact(contact: Contact) -> dict[str, Any]:
    return {
        "surface": contact.surface,
        "position": contact.pose.position.tolist(),
        "quaternion": contact.pose.quaternion.tolist(),
    }


def _described(effector: Effector | None) -> dict[str, Any]:
    if effector is None:
        return {}
    return {
        "kind": effector.kind,
        "friction": effector.friction,
        "link": effector.link,
        "frame": {
            "position": effector.frame.position.tolist(),
            "quaternion": effector.frame.quaternion.tolist(),
        },
    }
