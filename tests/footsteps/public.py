"""Public footsteps of 2023 (Taouil's repository) as footsteps of ours; see its README."""

from pathlib import Path

import numpy as np

from jaxleas.footsteps import FootstepRecords, Footsteps
from jaxleas.types import ControllerIdentity

FEET = ("FL", "FR", "RL", "RR")
PAIRS = ((0, 3), (1, 2))
LONGEST = 0.4  # a pause between two rows of one walk is shorter [s]


def simulated(folder: Path) -> FootstepRecords:
    """Return the footsteps of the simulated AlienGo: rows that follow each other on the clock."""
    parts = np.load(folder / "sim_footsteps.npz")
    kinds = ("continuous", "accelerations")
    columns = {
        name: np.concatenate([parts[f"{kind}_{name}"] for kind in kinds])
        for name in (
            *("command", "com_world_m", "feet_minus_com_world_m", "com_velocity_world_mps"),
            *("rotation_base_to_world", "fl_rr_swung"),
        )
    }
    # A week between the two files: no pair of rows spans them.
    time = [parts[f"{kind}_time_s"] for kind in kinds]
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
