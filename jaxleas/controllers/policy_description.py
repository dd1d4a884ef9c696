"""The JSON file beside an ONNX policy: what its numbers mean, and how its robot is driven."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.files import read_typed
from jaxleas.physics import Body, BodyState
from jaxleas.types import ControllerIdentity, InputError, matrix_of

VERSION = 1
Term = Literal[
    "command",
    "velocity",
    "turning_rate",
    "gravity",
    "angles",
    "joint_speeds",
    "last_action",
    "clock",
]
"""Part of an observation, in the root's frame: commanded speeds; velocity [m/s]; turning rate
[rad/s]; direction of gravity; joint angles less those of standing [rad]; joint speeds [rad/s]; the
policy's last output; sine and cosine of the place in the gait cycle."""


@dataclass(frozen=True)
class PolicyDescription:
    """How a policy sees and drives a robot.

    Attributes:
        version: version of the form of this file.
        robot: name of the robot.
        joints: names of the joints, in the policy's order.
        standing: angles that the policy's outputs are relative to [rad].
        stiffness: stiffness of the joints [Nm/rad].
        damping: damping of the joints [Nm s/rad].
        action_scale: angle that an output of 1 stands for [rad].
        period: time between two decisions, a multiple of 4 ms [s].
        observation: parts of the observation, in their order.
        pairs: names of the feet that swing together, in the order of their swings.
        swing_height: height of the apex of a swing [m].
        max_speeds: largest forward and sideways speed [m/s] and turning rate [rad/s].
        cycle: duration of a gait cycle, for "clock" [s]; 0 without.
        scales: what each part is multiplied by; 1 where it is not named.
    """

    version: int
    robot: str
    joints: tuple[str, ...]
    standing: tuple[float, ...]
    stiffness: float
    damping: float
    action_scale: float
    period: float
    observation: tuple[Term, ...]
    pairs: tuple[tuple[str, ...], ...]
    swing_height: float
    max_speeds: tuple[float, float, float]
    cycle: float = 0.0
    scales: dict[Term, float] = field(default_factory=dict)

    def order(self, body: Body) -> list[int]:
        """Return where each of the policy's joints is among the robot's."""
        return [body.joints.index(each) for each in self.joints]

    def identity(self, name: str, body: Body, digest: str) -> ControllerIdentity:
        """Return the identity of the policy as a controller.

        Args:
            name: name of the policy.
            body: robot.
            digest: SHA-256 of the policy's file.
        """
        pairs = tuple(tuple(body.feet.index(foot) for foot in pair) for pair in self.pairs)
        settings: dict[str, float | str] = {"policy_sha256": digest, "period": self.period}
        settings |= {"cycle": self.cycle, "stiffness": self.stiffness, "damping": self.damping}
        return ControllerIdentity(
            *(name, body.name, body.feet, pairs, self.swing_height, body.foot_radius),
            *(self.max_speeds, settings),
        )

    def observe(
        self,
        state: BodyState,
        command: Float[np.ndarray, "N 3"],
        last: np.ndarray,
        time: np.ndarray,
    ) -> Float[np.ndarray, "N S"]:
        """Return the observation of robots whose joints are in the policy's order.

        Args:
            state: state of the robots.
            command: commanded speeds.
            last: the policy's last output.
            time: time since the policy began [s].
        """
        rotation = matrix_of(state.quaternion)
        phase = 2.0 * np.pi * time / self.cycle if self.cycle else 0.0 * time
        parts = {
            "command": command,
            "velocity": (state.velocity[:, None] @ rotation)[:, 0],
            "turning_rate": state.turning_rate,
            "gravity": -rotation[:, 2],
            "angles": state.angles - np.array(self.standing),
            "joint_speeds": state.joint_speeds,
            "last_action": last,
            "clock": np.stack([np.sin(phase), np.cos(phase)], axis=1),
        }
        seen = [self.scales.get(term, 1.0) * parts[term] for term in self.observation]
        return np.concatenate(seen, axis=1)


def read_description(path: Path, body: Body) -> PolicyDescription:
    """Return the description of a policy of this robot.

    Raises:
        InputError: there is none, it is malformed, or it is of another robot.
    """
    found = read_typed(PolicyDescription, path, "description of a walking policy", VERSION)
    if found.robot != body.name:
        raise InputError(f"{path}: the policy walks {found.robot}, not {body.name}")
    if sorted(found.joints) != sorted(body.joints) or len(found.standing) != len(found.joints):
        raise InputError(
            f"{path}: joints must be those of {body.name} in any order, {', '.join(body.joints)},"
            " and standing one angle for each"
        )
    feet = sorted(foot for pair in found.pairs for foot in pair)
    if feet != sorted(body.feet):
        raise InputError(f"{path}: pairs must hold each of {', '.join(body.feet)} once")
    if "clock" in found.observation and not found.cycle > 0.0:
        raise InputError(f"{path}: cycle: the observation has a clock; give its duration [s]")
    if not (found.period > 0.0 and found.stiffness >= 0.0 and found.damping >= 0.0):
        raise InputError(f"{path}: period must be positive, stiffness and damping not negative")
    return found
