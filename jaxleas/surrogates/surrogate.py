"""A fitted surrogate: a contact planner's learned stand-in, with the planner's identity."""

from functools import cache
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Int
from pydantic import JsonValue

from jaxleas.configuration import Strict
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.robots import load_robot
from jaxleas.surrogates.features import MOTION_FEATURES, USUAL_PACE, Pace, near_points
from jaxleas.surrogates.network import Weights, recur


class Identity(Strict):
    """The planner that a surrogate stands in for, with its robot and observation."""

    planner: str
    """name of the planner, or MODULE:CLASS of the user's own"""
    parameters: dict[str, JsonValue]
    """parameters of the planner"""
    robot: str
    observation: str
    """name of the observation layout"""
    height_low: float
    """lower bound to which heights are clipped [m]"""
    height_high: float
    """upper bound to which heights are clipped [m]"""
    pace: Pace = USUAL_PACE
    """usual motion of the task that it was fitted for"""

    @classmethod
    def of(cls, planner: str, parameters: dict[str, JsonValue], env: SteeringConfig) -> Self:
        """Return the identity of a surrogate of a planner in an environment.

        Args:
            planner: name of the planner.
            parameters: all parameters of the planner.
            env: configuration of the environment.
        """
        return cls(
            planner=planner,
            parameters=parameters,
            robot=env.robot,
            observation=env.observation,
            height_low=env.height_low,
            height_high=env.height_high,
            pace=Pace.of(env),
        )

    @property
    def keep_every(self) -> int:
        """Number of time steps between two configurations that the planner is asked about."""
        return int(self.parameters["keep_every"])  # type: ignore[arg-type]

    @property
    def near(self) -> Int[np.ndarray, " points"]:
        """Indices of the points of the local terrain that the surrogate sees."""
        points = _points_in_root(self.robot, self.observation)
        return near_points(points, load_robot(self.robot).contact_window)

    @property
    def inputs(self) -> int:
        """Number of features of the network."""
        return len(self.near) + MOTION_FEATURES


@cache
def _points_in_root(robot: str, observation: str) -> Float[np.ndarray, "P 2"]:
    config = SteeringConfig.model_validate({"robot": robot, "observation": observation})
    return SteeringEnv(config).points_in_root


@struct.dataclass
class Surrogate:
    """A network, its calibration and its identity.

    Attributes:
        weights: weights of the network.
        scale: factor of the logit, from calibration (Platt 1999).
        shift: offset of the scaled logit, from calibration.
        identity: planner, robot and observation that the surrogate is for.
        report: results of the fit, as plain JSON values.
    """

    weights: Weights
    scale: Float[Array, ""]
    shift: Float[Array, ""]
    identity: Identity = struct.field(pytree_node=False)
    report: Any = struct.field(pytree_node=False, default=())

    def begin(self, batch: tuple[int, ...]) -> Float[Array, "*batch hidden"]:
        """Return the hidden state before a walk's first kept configuration."""
        return jnp.zeros((*batch, self.weights.hidden_size))

    def hazard(
        self, hidden: Float[Array, "*batch hidden"], features: Float[Array, "*batch size"]
    ) -> tuple[Float[Array, "*batch hidden"], Float[Array, "*batch"]]:
        """Return the next hidden state and the probability that the planner fails just here.

        "Here" is the stretch from the previous kept configuration to this one, given that the
        planner got to its start.
        """
        hidden, logit = recur(self.weights, hidden, features)
        return hidden, jax.nn.sigmoid(self.scale * logit + self.shift)
