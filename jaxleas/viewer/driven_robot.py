"""One robot that a policy walks, one time step at a time, as long as the page is shown."""

from dataclasses import dataclass
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from jaxleas.envs.steering import SteeringEnv
from jaxleas.geometry import wrap_angle_on_host
from jaxleas.guide import OnnxPolicy, leas
from jaxleas.terrain import Atlas
from jaxleas.training import Policy
from jaxleas.types import RootMotion, RootPose

State = Literal["waiting", "walking", "arrived", "invalid"]


@dataclass
class Sight:
    """The observation of a robot at its current configuration.

    Attributes:
        heights: heights of the observation's grid relative to the root, clipped as the policy sees
            them [m].
        margin: margin of the environment's condition [m].
    """

    heights: Float[np.ndarray, " points"]
    margin: float


class DrivenRobot:
    """A robot, its policy and its goal.

    The first step, made on construction, compiles everything: a step afterwards takes a fraction
    of a millisecond, whatever the goal.

    Attributes:
        name: name of the policy on the page.
        env: environment that the policy was trained in.
        state: "waiting" for a first goal, "walking", "arrived" or "invalid": standing in a
            configuration that violates the condition, until `reset`.
        sight: observation at the current configuration.
        steps: number of steps since the start.
    """

    def __init__(
        self, name: str, env: SteeringEnv, policy: Policy | OnnxPolicy, atlas: Atlas
    ) -> None:
        """Compile the step.

        Args:
            name: name of the policy on the page.
            env: environment built from the policy's own config.
            policy: policy that steers.
            atlas: atlas whose only map is the terrain.
        """
        self.name, self.env = name, env
        method = leas(env, policy)
        on_host = getattr(method, "runs_on_host", False)
        self._move = method if on_host else jax.jit(method.__call__)
        self._keep = jax.jit(lambda motion, asked: _kept(env, atlas, motion, asked))
        self._look = jax.jit(lambda motion: _look(env, atlas, motion))
        self.reset(RootPose.identity())
        self.step()
        self.reset(RootPose.identity())

    def reset(self, start: RootPose) -> None:
        """Stand still at a start, without a goal."""
        self._motion = RootMotion(
            position=jnp.asarray(start.position, jnp.float32)[None],
            velocity=jnp.zeros((1, 3), jnp.float32),
            yaw=jnp.asarray([start.yaw], jnp.float32),
        )
        self.before = self.pose = RootPose.from_yaw(start.position, start.yaw)
        self._goal: tuple[float, float] | None = None
        self.steps = 0
        self._perceive()
        self.state: State = "waiting" if self.sight.margin >= 0.0 else "invalid"

    def seek(self, goal: tuple[float, float]) -> None:
        """Walk to a goal (x, y) [m] from now on."""
        self._goal = (float(goal[0]), float(goal[1]))
        if self.state != "invalid":
            self.state = "walking"

    def stop(self) -> None:
        """Stand where the robot is, as on arrival."""
        if self.state == "walking":
            self._halt("waiting")

    def step(self) -> None:
        """Move for one time step (T eq. 3.3); arrive, or fail, as in a roll-out."""
        goal = self._goal or (0.0, 0.0)
        target = jnp.asarray([[goal[0], goal[1], 0.0]], jnp.float32)  # LEAS only uses x and y
        asked = self._move(self._heights, self._motion, target)
        self._motion = self._keep(self._motion, asked)
        moved = _pose(self._motion)
        self.before, self.pose = self.pose, moved or self.pose
        self.steps += 1
        self._perceive()
        if moved is None or not self.sight.margin >= 0.0:  # nor is a NaN margin valid
            self._halt("invalid")
        elif np.hypot(*(self.pose.position[:2] - goal)) <= self.env.config.goal_radius:
            self._halt("arrived")

    @property
    def seconds(self) -> float:
        """Time walked since the start, on the robot's clock [s]."""
        return self.steps * self.env.config.limits.time_step

    @property
    def goal(self) -> tuple[float, float] | None:
        """The last goal of the robot (x, y) [m]."""
        return self._goal

    def between(self, share: float) -> RootPose:
        """Return the pose at a share, 0 to 1, of the way between the last two configurations."""
        turn = float(wrap_angle_on_host(self.pose.yaw - self.before.yaw))
        way = self.pose.position - self.before.position
        return RootPose.from_yaw(self.before.position + share * way, self.before.yaw + share * turn)

    def points_seen(self) -> Float[np.ndarray, "points 3"]:
        """Return the observation's grid in the root frame, at the observed heights [m]."""
        return np.column_stack([self.env.layout.points_in_root, self.sight.heights])

    def _halt(self, state: State) -> None:
        self.state = state
        self._motion = RootMotion(
            position=self._motion.position,
            velocity=jnp.zeros_like(self._motion.velocity),
            yaw=self._motion.yaw,
        )

    def _perceive(self) -> None:
        self._heights, seen, margin = self._look(self._motion)
        self.sight = Sight(np.asarray(seen[0]), float(margin[0]))


def _look(
    env: SteeringEnv, atlas: Atlas, motion: RootMotion
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return the local heights, the heights that the policy observes, and the margin."""
    heights = env.local_heights(atlas, jnp.zeros(motion.yaw.shape, jnp.int32), motion)
    seen = jnp.clip(heights[:, : len(env.layout.points_in_root)], *env.height_range)
    return heights, seen, env.condition(heights, motion)


def _kept(env: SteeringEnv, atlas: Atlas, motion: RootMotion, asked: RootMotion) -> RootMotion:
    """Return the motion that the guard lets pass, if the environment has one."""
    if env.guard is None:
        return asked
    return env.guard(atlas, jnp.zeros(motion.yaw.shape, jnp.int32), motion, asked)


def _pose(motion: RootMotion) -> RootPose | None:
    """Return where a robot is; None where its policy answered with what is no number."""
    position, yaw = np.asarray(motion.position[0], np.float64), float(motion.yaw[0])
    finite = bool(np.isfinite([*position, yaw]).all())
    return RootPose.from_yaw(position, yaw) if finite else None
