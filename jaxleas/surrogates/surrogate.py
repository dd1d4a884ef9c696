"""A fitted surrogate: a contact planner's learned stand-in, and exactly which planner's."""

from functools import cache
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Int
from pydantic import JsonValue

from jaxleas.configuration.strict import Strict
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.robots import load_robot
from jaxleas.surrogates.features import MOTION_FEATURES, near_points
from jaxleas.surrogates.network import Weights, recur


class Identity(Strict):
    """Whose stand-in a surrogate is, and for which robot and observation."""

    planner: str
    """name of the planner, or MODULE:CLASS of the user's own"""
    parameters: dict[str, JsonValue]
    """of the planner"""
    robot: str
    observation: str
    """layout of the local terrain"""
    height_low: float
    """heights are clipped from below here [m]"""
    height_high: float
    """and from above here [m]"""

    @classmethod
    def of(cls, planner: str, parameters: dict[str, JsonValue], env: SteeringConfig) -> Self:
        """Return whose stand-in a surrogate of a planner is in an environment.

        Args:
            planner: its name.
            parameters: of the planner, all of them.
            env: configuration of the environment.
        """
        return cls(
            planner=planner,
            parameters=parameters,
            robot=env.robot,
            observation=env.observation,
            height_low=env.height_low,
            height_high=env.height_high,
        )

    @property
    def keep_every(self) -> int:
        """Time steps from one configuration that the planner is asked about to the next."""
        return int(self.parameters["keep_every"])  # type: ignore[arg-type]

    @property
    def near(self) -> Int[np.ndarray, " points"]:
        """Indices of the points that the surrogate is shown among all of the local terrain."""
        points = _points_in_root(self.robot, self.observation)
        return near_points(points, load_robot(self.robot).contact_window)

    @property
    def inputs(self) -> int:
        """Number of features that the network is shown."""
        return len(self.near) + MOTION_FEATURES


@cache
def _points_in_root(robot: str, observation: str) -> Float[np.ndarray, "P 2"]:
    config = SteeringConfig.model_validate({"robot": robot, "observation": observation})
    return SteeringEnv(config).points_in_root


@struct.dataclass
class Surrogate:
    """A network, its calibration and its identity.

    Attributes:
        weights: of the network.
        scale: of the logit, from calibration (Platt 1999).
        shift: likewise.
        identity: whose stand-in this is.
        report: what fitting measured, as plain JSON values.
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

        "Here" is from the kept configuration before to this one, given that it got that far.
        """
        hidden, logit = recur(self.weights, hidden, features)
        return hidden, jax.nn.sigmoid(self.scale * logit + self.shift)
