"""Public footsteps of 2023, of the repository behind Taouil's thesis, and models fitted to them.

They are those of `data/sim` of github.com/itaouil/footstep_planner, packed into arrays.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from benchmarks.contacts.rows import Row
from jaxleas.files import read_npz
from jaxleas.footsteps import FitSettings, FootstepRecords, Footsteps, Score, fit_motion_models
from jaxleas.types import ControllerIdentity, InputError

FILE = "sim_footsteps.npz"
FORWARD = FitSettings(movements=("forward",), network=False)
"""How they are fitted: they hold forward commands alone."""

FEET = ("FL", "FR", "RL", "RR")
PAIRS = ((0, 3), (1, 2))
LONGEST = 0.4  # a pause between two rows of one walk is shorter [s]


KINDS = ("continuous", "accelerations")
COLUMNS = (
    *("command", "com_world_m", "feet_minus_com_world_m", "com_velocity_world_mps"),
    *("rotation_base_to_world", "fl_rr_swung"),
)


def public_rows(folder: Path) -> Iterator[Row]:
    """Yield the figures of models fitted to the public footsteps.

    Args:
        folder: folder that holds `sim_footsteps.npz`.
    """
    yield from rows_of(fit_motion_models(simulated(folder), FORWARD).scores)


def rows_of(scores: Sequence[Score]) -> Iterator[Row]:
    """Yield R2 and mean error, by run, of C4 for the x of the centre of mass: the worse pair's."""
    found = [
        each
        for each in scores
        if (each.target, each.predictors, each.split) == ("com x", "C4", "run")
        and (each.model, each.movement) == ("linear", "all")
    ]
    yield Row("public_com_x_c4_r2", "%", [min(each.r2 or 0.0 for each in found)], better="higher")
    yield Row("public_com_x_c4_error", "mm", [max(each.error for each in found)])


def simulated(folder: Path) -> FootstepRecords:
    """Return the footsteps of the simulated AlienGo: rows that follow each other on the clock.

    Raises:
        InputError: the folder holds no such file, or it lacks an array.
    """
    file = folder / FILE
    if not file.is_file():
        raise InputError(f"{folder} holds no {FILE}: give the folder of the public footsteps")
    names = tuple(f"{kind}_{name}" for kind in KINDS for name in (*COLUMNS, "time_s"))
    parts = read_npz(file, names)
    columns = {
        name: np.concatenate([parts[f"{kind}_{name}"] for kind in KINDS]) for name in COLUMNS
    }
    # A week between the two files: no pair of rows spans them.
    time = [parts[f"{kind}_time_s"] for kind in KINDS]
    return _records(columns, np.concatenate([time[0], time[1] + 1e6]), len(time[0]))


def _records(columns: dict[str, np.ndarray], time: np.ndarray, steady: int) -> FootstepRecords:
    command = np.round(columns["command"].astype(float), 1)
    com = columns["com_world_m"].astype(float)
    feet = com[:, None] + columns["feet_minus_com_world_m"]
    rotation = columns["rotation_base_to_world"]
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0]).astype(float)
    pause = np.diff(time, prepend=np.nan)
    turned = np.diff(yaw, prepend=np.nan)
    turning = np.angle(np.exp(1j * turned)) / pause
    follows = (pause > 0) & (pause < LONGEST)
    turning = np.where(follows, turning, 0.0)
    velocity = columns["com_velocity_world_mps"].astype(float)
    after = np.flatnonzero(follows)
    before = after - 1
    footsteps = Footsteps(
        run=_runs(command, steady)[after],
        time=time[after] - time[0],
        pair=np.where(columns["fl_rr_swung"][after], 0, 1),
        com_before=com[before],
        com_after=com[after],
        yaw_before=yaw[before],
        yaw_after=yaw[after],
        com_velocity_before=velocity[before],
        com_velocity_after=velocity[after],
        yaw_rate_before=turning[before],
        yaw_rate_after=turning[after],
        feet_before=feet[before],
        feet_after=feet[after],
        previous_command=command[before],
        command=command[after],
        apex=np.full(len(after), np.nan),
    )
    identity = ControllerIdentity(
        name="DLS MPC of 2023",
        robot="aliengo",
        feet=FEET,
        pairs=PAIRS,
        swing_height=0.065,
        foot_radius=0.0265,
        max_speeds=(1.1, 0.0, 0.0),
    )
    return FootstepRecords(footsteps, identity, "contact", {"pause": int((~follows).sum())})


def _runs(command: np.ndarray, steady: int) -> np.ndarray:
    """Return the number of each row's run: 12 steady speeds, 11 speeds that others start from."""
    level = np.round(command[:, 0] * 10).astype(int)
    later = level[steady:]
    begins = np.flatnonzero(np.diff(later, prepend=-1))
    following = np.append(later[begins][1:], later[-1])
    start = np.repeat(np.minimum(later[begins], following), np.diff(begins, append=len(later)))
    return np.concatenate([level[:steady], 12 + start])
