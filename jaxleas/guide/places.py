"""The places of a terrain where a robot can stand: test them, and draw them."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from jaxleas.conditions import collision, strict_reachability
from jaxleas.envs.steering import SteeringEnv
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.robots import Robot
from jaxleas.terrain import HeightMap, make_atlas
from jaxleas.types import InputError, RootMotion, RootPose, is_ground

HEADINGS = np.linspace(-math.pi, math.pi, 8, endpoint=False)
"""A robot can stand at a place if any of these headings is valid there [rad]."""
_AT_ONCE, _FEW = 4096, 16  # poses tried in one compiled call


class Places:
    """The places of one terrain where a robot can stand, at walking height and at rest."""

    def __init__(self, env: SteeringEnv, terrain: HeightMap):
        """Prepare.

        Args:
            env: environment with the condition and the robot's walking height.
            terrain: height map to stand on.
        """
        self.env, self.terrain = env, terrain
        self.atlas = make_atlas([terrain])
        conditions = {
            "strict reachability R*": strict_reachability(env.robot, env.points_in_root),
            "collision C": collision(env.robot, env.points_in_root),
            "the condition": env.condition,
        }

        def margins(motion: RootMotion) -> dict[str, jax.Array]:
            heights = env.local_heights(self.atlas, jnp.zeros(motion.yaw.shape, jnp.int32), motion)
            return {name: condition(heights, motion) for name, condition in conditions.items()}

        self._margins = jax.jit(margins)

    def root_height(self, places: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, " N"]:
        """Return the root's z at walking height [m]; NaN where there is no ground."""
        ground = self.terrain.height_at(places).astype(np.float64)
        return ground + self.env.robot.walking_height

    def standing_positions(self, places: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, "N 3"]:
        """Return root positions at walking height [m]; where there is no ground, above z = 0."""
        ground = self.terrain.height_at(places).astype(np.float64)
        height = walking_heights(self.env.robot, ground, self.env.robot.walking_height)
        return np.column_stack([places, height]).astype(np.float32)

    def standing(
        self, places: Float[np.ndarray, "N 2"], yaw: Float[np.ndarray, " N"]
    ) -> RootMotion:
        """Return roots at rest at walking height; where there is no ground, above z = 0."""
        position = self.standing_positions(places)
        wrapped = wrap_angle_on_host(yaw)
        return on_host(position, np.zeros_like(position), wrapped.astype(np.float32))

    def margins(
        self, places: Float[np.ndarray, "N 2"], yaw: Float[np.ndarray, " N"]
    ) -> dict[str, Float[np.ndarray, " N"]]:
        """Return the margins [m] of R*, of C and of the environment's condition, by name."""
        return self.margins_of(self.standing(places, yaw))

    def margins_of(self, motion: RootMotion) -> dict[str, Float[np.ndarray, " N"]]:
        """Return the margins [m] of R*, of C and of the environment's condition, by name.

        Args:
            motion: root motions at any height, of NumPy arrays.
        """
        parts = []
        for first in range(0, len(motion.yaw), _AT_ONCE):
            some = jax.tree.map(lambda leaf, at=first: leaf[at : at + _AT_ONCE], motion)
            count = len(some.yaw)
            size = _AT_ONCE if count > _FEW else _FEW  # two compiled sizes are enough
            padded = jax.tree.map(lambda leaf, n=count, to=size: _padded(leaf, to, n), some)
            parts.append({k: np.asarray(v)[:count] for k, v in self._margins(padded).items()})
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}

    def valid(
        self, places: Float[np.ndarray, "N 2"], yaw: Float[np.ndarray, " N"]
    ) -> Bool[np.ndarray, " N"]:
        """Tell which poses satisfy the environment's condition above ground."""
        margin = self.margins(places, yaw)["the condition"]
        return np.logical_and(margin >= 0.0, is_ground(self.root_height(places)))

    def valid_anyhow(self, places: Float[np.ndarray, "N 2"]) -> Bool[np.ndarray, " N"]:
        """Tell which places are valid with some heading."""
        turned = np.tile(HEADINGS, len(places))
        each = self.valid(np.repeat(places, len(HEADINGS), axis=0), turned)
        return np.logical_or.reduce(each.reshape(len(places), -1), axis=1)

    def draw(
        self, rng: np.random.Generator, count: int, clearance: float = 0.0
    ) -> Float[np.ndarray, "count 2"]:
        """Draw places uniformly over those of the terrain that are valid with some heading.

        Args:
            rng: random generator to draw with.
            count: number of places to draw.
            clearance: distance at which the robot must also be able to stand in eight directions
                [m]; 0.3 leaves out the tops of narrow boxes, which no robot can climb or leave.

        Raises:
            InputError: there are hardly any such places.
        """
        x_min, x_max, y_min, y_max = self.terrain.extent
        found: list[np.ndarray] = []
        for _ in range(100):
            drawn = rng.uniform((x_min, y_min), (x_max, y_max), (512, 2))
            drawn = drawn[self.valid_anyhow(drawn)]
            if clearance > 0.0:
                around = clearance * np.column_stack([np.cos(HEADINGS), np.sin(HEADINGS)])
                ring = (drawn[:, None] + around).reshape(-1, 2)
                drawn = drawn[self.valid_anyhow(ring).reshape(len(drawn), -1).all(axis=1)]
            found += [*drawn]
            if len(found) >= count:
                return np.array(found[:count])
        raise InputError("there is hardly a place on this terrain where the robot can stand")

    def pose(self, place: Float[np.ndarray, " 2"], yaw: float) -> RootPose:
        """Return the pose of a root at walking height.

        Raises:
            InputError: there is no ground.
        """
        return RootPose.from_yaw(np.array([*place, self.root_height(place[None])[0]]), yaw)


def walking_heights(
    robot: Robot, ground: Float[np.ndarray, " N"], over_void: Float[np.ndarray, " N"] | float
) -> Float[np.ndarray, " N"]:
    """Return the root's z at walking height over some ground [m].

    Args:
        robot: robot that walks.
        ground: heights of the ground [m], from a height map.
        over_void: z of the root where there is no ground [m].
    """
    return np.where(is_ground(ground), ground + robot.walking_height, over_void)


def on_host(position: np.ndarray, velocity: np.ndarray, yaw: np.ndarray) -> RootMotion:
    """Return a root motion of NumPy arrays, which a search reads value by value."""
    return RootMotion(position, velocity, yaw)  # type: ignore[arg-type]


def _padded(leaf: np.ndarray, size: int, count: int) -> np.ndarray:
    return np.concatenate([leaf, np.repeat(leaf[-1:], size - count, axis=0)])
