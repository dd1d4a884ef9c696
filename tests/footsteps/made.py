"""Footsteps of a made-up walker whose law is known: what it does is linear in what it is told."""

from dataclasses import replace

import numpy as np

from jaxleas.footsteps import FootstepRecords, Footsteps
from jaxleas.types import ControllerIdentity

IDENTITY = ControllerIdentity(
    name="made up",
    robot="probe",
    feet=("LF", "RF", "LH", "RH"),
    pairs=((0, 3), (1, 2)),
    swing_height=0.08,
    foot_radius=0.02,
    max_speeds=(0.8, 0.4, 0.8),
)
STEP_TIME = 0.3
NOMINAL = np.array([[0.34, 0.2], [0.34, -0.2], [-0.34, 0.2], [-0.34, -0.2]])
RIDE_HEIGHT = 0.45
LAG = 0.4
"""Share of its former velocity that the walker keeps over a footstep."""
MOVES = np.array([(1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1)], dtype=float)


def walked(runs: int = 10, steps: int = 60, noise: float = 0.0, seed: int = 0) -> FootstepRecords:
    """Return footsteps of a walker that lags behind its commands, each run one movement."""
    generator = np.random.default_rng(seed)
    rows = [
        row for run in range(runs) for row in _run(run, MOVES[run % 5], steps, noise, generator)
    ]
    columns = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return FootstepRecords(Footsteps(**columns), IDENTITY, "contact", {"apex too low": 3})


def _run(number, move, steps, noise, generator):
    """Yield the footsteps of one run, as rows."""
    yaw = generator.uniform(-np.pi, np.pi)
    com = np.append(generator.uniform(-2, 2, 2), RIDE_HEIGHT)
    feet = _on_ground(com, yaw, NOMINAL)
    previous, velocity, rate, level = np.zeros(3), np.zeros(3), 0.0, 0.0
    for step in range(steps):
        level = generator.integers(1, 11) / 10 if step % 4 == 0 else level
        command = move * level * np.array(IDENTITY.max_speeds)
        pair = step % 2
        before = (com, yaw, velocity, rate, feet)
        local = LAG * _turned(velocity, -yaw)[:2] + (1 - LAG) * command[:2]
        rate = LAG * rate + (1 - LAG) * command[2]
        shift = STEP_TIME * local + noise * generator.normal(size=2)
        com = com + np.append(_turned(np.append(shift, 0.0), yaw)[:2], 0.0)
        velocity = _turned(np.append(local, 0.0), yaw)
        yaw = yaw + STEP_TIME * rate + noise * generator.normal()
        feet = feet.copy()
        # A foot lands ahead of its hip by half of what the trunk moves in a footstep.
        landing = NOMINAL + 0.5 * STEP_TIME * command[:2] + noise * generator.normal(size=(4, 2))
        swinging = list(IDENTITY.pairs[pair])
        feet[swinging] = _on_ground(com, yaw, landing)[swinging]
        yield {
            **{"run": number, "time": (step + 1) * STEP_TIME, "pair": pair, "apex": 0.08},
            **{"com_before": before[0], "com_after": com},
            **{"yaw_before": before[1], "yaw_after": yaw},
            **{"com_velocity_before": before[2], "com_velocity_after": velocity},
            **{"yaw_rate_before": before[3], "yaw_rate_after": rate},
            **{"feet_before": before[4], "feet_after": feet},
            **{"previous_command": previous, "command": command},
        }
        previous = command


def _turned(vector, yaw):
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array(
        [cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1], vector[2]]
    )


def _on_ground(com, yaw, points):
    return np.array(
        [np.append(com[:2] + _turned(np.append(point, 0), yaw)[:2], 0.0) for point in points]
    )


def elsewhere(footsteps: Footsteps, yaw: float, shift: np.ndarray) -> Footsteps:
    """Return the same footsteps in a world that is turned and moved."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    moved = {
        name: getattr(footsteps, name) @ turn.T + shift
        for name in ("com_before", "com_after", "feet_before", "feet_after")
    }
    turned = {
        name: getattr(footsteps, name) @ turn.T
        for name in ("com_velocity_before", "com_velocity_after")
    }
    yaws = {name: getattr(footsteps, name) + yaw for name in ("yaw_before", "yaw_after")}
    return replace(footsteps, **moved, **turned, **yaws)
