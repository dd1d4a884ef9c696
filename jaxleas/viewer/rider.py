"""A driven robot and its shape on the page, moved evenly between configurations."""

from collections.abc import Callable

import numpy as np

from jaxleas.types import RootPose
from jaxleas.viewer.driven_robot import DrivenRobot
from jaxleas.viewer.robot_shape import RobotShape

MOST_STEPS_A_FRAME = 10
"""Maximum number of steps per frame: with more the page would freeze while robots walk."""
TRAIL_EVERY, SEEN_EVERY = 9, 4
"""Frames between two drawings of the trail, and of what the policy sees: the page rebuilds each of
them."""


class Rider:
    """A driven robot and its shape on the page."""

    def __init__(self, driven: DrivenRobot, shape: RobotShape, start: RootPose) -> None:
        self.driven, self.shape, self._start = driven, shape, start
        self.time_step = driven.env.config.limits.time_step
        self.reset()

    def reset(self) -> None:
        """Return to the start."""
        self.driven.reset(self._start)
        self._elapsed, self._frames = 0.0, 0
        self.shape.trail.begin(self._start.position)
        self._draw()

    def advance(self, seconds: float, steer: Callable[[DrivenRobot], None]) -> None:
        """Advance the robot; the shape moves evenly between configurations.

        Args:
            seconds: time on the robot's clock [s].
            steer: function called before each step.
        """
        if self.driven.state != "walking":
            return
        self._frames += 1
        self._elapsed = min(self._elapsed + seconds, MOST_STEPS_A_FRAME * self.time_step)
        while self._elapsed >= self.time_step and self.driven.state == "walking":
            self._elapsed -= self.time_step
            steer(self.driven)
            self.driven.step()
            self.shape.trail.add(self.driven.pose.position)
        stands = self.driven.state != "walking"
        if stands or self._frames % TRAIL_EVERY == 0:
            self.shape.trail.draw()
        if self._frames % SEEN_EVERY == 0:
            self._perceive()
        self._draw()

    def _draw(self) -> None:
        walking = self.driven.state == "walking" and self.driven.steps > 0
        self.shape.place(
            self.driven.between(self._elapsed / self.time_step) if walking else self.driven.pose
        )
        if not walking:
            self._perceive()

    def _perceive(self) -> None:
        low, high = self.driven.env.height_range
        share = (self.driven.sight.heights - low) / (high - low)
        self.shape.show_seen(self.driven.points_seen(), np.clip(share, 0.0, 1.0))
        self.shape.mark(self.driven.state != "invalid")
