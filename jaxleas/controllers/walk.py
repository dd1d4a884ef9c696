"""Robots that a controller walks through physics, one tick after another."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.controller import Controller, JointCommand
from jaxleas.physics import BodyState, Physics, Sensed, Stepped
from jaxleas.types import InputError

TICK = 0.004
"""Time between two torques; a controller may decide more rarely [s]."""


@dataclass(frozen=True, eq=False)
class Walking:
    """N robots that walk.

    Attributes:
        memory: memory of the controller.
        wanted: what the joints were last told to do.
        state: state now.
        sensed: latest measurements.
        ticks: number of ticks since the beginning.
    """

    memory: Any
    wanted: JointCommand
    state: BodyState
    sensed: Sensed
    ticks: int


@dataclass(frozen=True, eq=False)
class Ticked:
    """What happened in one tick.

    Attributes:
        before: state that it began in.
        walking: the robots after it.
        torques: torques that were applied, noise included and within the motors' limits [Nm].
        stepped: its physics steps.
    """

    before: BodyState
    walking: Walking
    torques: Float[np.ndarray, "N J"]
    stepped: Stepped


class Walk:
    """A controller that walks robots in physics.

    Attributes:
        physics: simulator.
        controller: controller of all robots.
        noise: standard deviation of what is added to each torque, anew at each tick [Nm].
    """

    def __init__(self, physics: Physics, controller: Controller, noise: float = 0.0) -> None:
        self.physics = physics
        self.controller = controller
        self.noise = noise
        self._steps = _whole(TICK, physics.body.time_step, "the time step of the robot's file")
        self._every = _whole(controller.period, TICK, "the tick")

    def begin(self, state: BodyState) -> Walking:
        """Return robots that stand at rest.

        Args:
            state: state to begin from; one physics step under the standing torques makes the first
                measurements.
        """
        body = self.physics.body
        still = np.zeros((len(state), len(body.standing)))
        wanted = JointCommand(still, state.angles, STANDING_STIFFNESS, STANDING_DAMPING)
        stepped = self.physics.step(state, wanted.torques_at(state))
        memory = self.controller.start(stepped.state)
        return Walking(memory, wanted, stepped.state, stepped.sensed, 0)

    def tick(
        self,
        walking: Walking,
        command: Float[np.ndarray, "N 3"],
        rng: np.random.Generator | None = None,
    ) -> Ticked:
        """Walk for one tick.

        Args:
            walking: robots before it.
            command: forward and sideways speed [m/s] and turning rate [rad/s] in each robot's
                frame.
            rng: source of the torques' noise; None for no noise.
        """
        memory, wanted = walking.memory, walking.wanted
        if walking.ticks % self._every == 0:
            memory, wanted = self.controller.act(memory, walking.state, walking.sensed, command)
        torques = wanted.torques_at(walking.state)
        if rng is not None and self.noise > 0.0:
            torques = torques + self.noise * rng.standard_normal(torques.shape)
        limit = self.physics.body.largest_torque
        torques = np.clip(torques, -limit, limit)
        stepped = self.physics.step(walking.state, torques, self._steps)
        after = Walking(memory, wanted, stepped.state, stepped.sensed, walking.ticks + 1)
        return Ticked(walking.state, after, torques, stepped)


STANDING_STIFFNESS, STANDING_DAMPING = 200.0, 8.0
"""Spring and damper with which joints stand until the controller's first decision [Nm/rad]."""


def _whole(period: float, of: float, what: str) -> int:
    """Return how often one period holds another.

    Raises:
        InputError: not a whole number of times.
    """
    count = round(period / of)
    if count < 1 or abs(count * of - period) > 1e-9:
        raise InputError(f"a period of {period:g} s is no multiple of {what}, {of:g} s")
    return count
