"""Logs of walks: state and torques of every physics step, from which plain MuJoCo repeats them."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from jaxleas.controllers import Ticked, Walk
from jaxleas.crossing.walked_footsteps import WalkedFootstep
from jaxleas.files import parse_json, read_npz, require_version, typed, write_npz
from jaxleas.types import ControllerIdentity, InputError

VERSION = 1
MAX_BYTES = 2**32
"""Largest size of the unpacked arrays: three hours."""


@dataclass(frozen=True)
class WalkDescription:
    """What a log says besides its numbers.

    Attributes:
        controller: controller that walked.
        time_step: duration of a physics step [s].
        steps_per_tick: physics steps between two torques; MuJoCo's solver begins cold at each.
        outcome: how the walk ended.
        settings: terrain, goals, start and search.
        provenance: versions, command and machine.
        version: version of the file.
    """

    controller: ControllerIdentity
    time_step: float
    steps_per_tick: int
    outcome: dict[str, Any]
    settings: dict[str, Any]
    provenance: dict[str, Any]
    version: int = VERSION


@dataclass(frozen=True, eq=False)
class WalkLog:
    """A walk of one robot with J joints in K physics steps, with F footsteps.

    Attributes:
        mjcf: text of the world that MuJoCo loads.
        time: time of each state [s].
        coordinates: position and quaternion (w, x, y, z) of the root, angles of the joints.
        speeds: velocity of the root, its turning rate in its own frame, speeds of the joints.
        torques: torques in each physics step [Nm].
        command: command in force [m/s, m/s, rad/s].
        footsteps: footsteps, as arrays by name.
        description: what else there is to know.
    """

    mjcf: str
    time: Float[np.ndarray, " K+1"]
    coordinates: Float[np.ndarray, "K+1 7+J"]
    speeds: Float[np.ndarray, "K+1 6+J"]
    torques: Float[np.ndarray, "K J"]
    command: Float[np.ndarray, "K 3"]
    footsteps: dict[str, np.ndarray]
    description: WalkDescription


class WalkLogger:
    """Keeps all states and torques of one of the robots that walk.

    Args:
        walk: controller in physics.
        robot: index of the robot.
    """

    def __init__(self, walk: Walk, robot: int = 0) -> None:
        self._walk, self._robot = walk, robot
        self._rows: list[np.ndarray] = []
        self._torques: list[np.ndarray] = []

    def __call__(self, ticked: Ticked, command: Float[np.ndarray, "N 3"]) -> None:
        """Keep the states before and after each physics step of a tick."""
        before = ticked.before
        if not self._rows:
            self._keep(before)
        for state in ticked.stepped.states:
            self._keep(state)
            self._torques.append(np.append(ticked.torques[self._robot], command[self._robot]))

    def _keep(self, state: Any) -> None:
        index = self._robot
        parts = state.time[index : index + 1], state.coordinates[index], state.speeds[index]
        self._rows.append(np.concatenate(parts))

    def made(self, footsteps: dict[str, np.ndarray], description: WalkDescription) -> WalkLog:
        """Return the log.

        Args:
            footsteps: footsteps of the robot, as `footstep_arrays` returns them.
            description: what else there is to know.
        """
        joints = len(self._walk.physics.body.joints)
        rows = np.array(self._rows).reshape(len(self._rows), -1)
        width = 7 + joints
        torques = np.array(self._torques).reshape(-1, joints + 3)
        return WalkLog(
            *(self._walk.physics.mjcf, rows[:, 0], rows[:, 1 : 1 + width], rows[:, 1 + width :]),
            *(torques[:, :joints], torques[:, joints:], footsteps, description),
        )


def footstep_arrays(footsteps: tuple[WalkedFootstep, ...]) -> dict[str, np.ndarray]:
    """Return footsteps as arrays: what was planned is NaN where nothing was."""
    feet = footsteps[0].feet.shape if footsteps else (0, 3)
    nothing = np.full(feet, np.nan)
    planned = [nothing if each.planned is None else each.planned.feet for each in footsteps]
    return {
        "footstep_time": np.array([each.time for each in footsteps]),
        "footstep_pair": _pairs([each.pair for each in footsteps]),
        "footstep_expected": _pairs([each.expected for each in footsteps]),
        "footstep_command": np.array([each.command for each in footsteps]).reshape(-1, 3),
        "footstep_com": np.array([each.com for each in footsteps]).reshape(-1, 3),
        "footstep_yaw": np.array([each.yaw for each in footsteps]),
        "footstep_feet": np.array([each.feet for each in footsteps]).reshape(len(footsteps), *feet),
        "footstep_planned": np.array(planned).reshape(len(footsteps), *feet),
        "footstep_controller": np.array([each.controller for each in footsteps], dtype=np.str_),
    }


def _pairs(pairs: list[int | None]) -> Int[np.ndarray, " F"]:
    return np.array([-1 if each is None else each for each in pairs], dtype=np.int64)


_STATES = ("time", "coordinates", "speeds", "torques", "command")


def write_walk_log(path: str | Path, log: WalkLog) -> None:
    """Write a log, whole or not at all."""
    write_npz(
        path,
        metadata=np.array(json.dumps(asdict(log.description))),
        mjcf=np.array(log.mjcf),
        **{name: getattr(log, name) for name in _STATES},
        **log.footsteps,
    )


def read_walk_log(path: str | Path) -> WalkLog:
    """Read a log.

    Raises:
        InputError: the file holds no log of a walk, is damaged, or is of another version.
    """
    arrays = read_npz(path, ("metadata", "mjcf", *_STATES), MAX_BYTES)
    content = parse_json(str(arrays["metadata"]), f"{path}: metadata")
    if isinstance(content, dict):
        require_version(content, VERSION, path)
    description = typed(WalkDescription, content, f"{path}: metadata of no walk")
    steps = len(arrays["torques"])
    for name in ("time", "coordinates", "speeds"):
        if len(arrays[name]) != steps + 1:
            raise InputError(
                f"{path}: {name} has {len(arrays[name])} rows; {steps} physics steps have"
                f" {steps + 1} states"
            )
    footsteps = {name: each for name, each in arrays.items() if name.startswith("footstep_")}
    states = {name: arrays[name] for name in _STATES}
    return WalkLog(str(arrays["mjcf"]), **states, footsteps=footsteps, description=description)
