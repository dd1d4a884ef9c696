"""Physics by `mujoco.rollout`: MuJoCo on a pool of threads, one robot after another on each."""

import os
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.physics.bodies import Body
from jaxleas.physics.mujoco_extra import import_mujoco
from jaxleas.physics.simulation import Stepped
from jaxleas.physics.state import BodyState, sensed_from
from jaxleas.physics.variation import Variation, varied_model
from jaxleas.types import InputError


class ThreadedPhysics:
    """N copies of a robot in MuJoCo.

    Every call begins with a cold solver, so that a state and its torques determine what follows: a
    log replayed in plain MuJoCo gives the same states.

    Attributes:
        body: robot.
        mjcf: text of the world.
        models: compiled model of each robot.
    """

    def __init__(
        self, body: Body, mjcf: str, model: Any, count: int, variation: Variation | None
    ) -> None:
        mujoco = import_mujoco()
        from mujoco import rollout

        self.body = body
        self.mjcf = mjcf
        self.models = (
            [model] * count
            if variation is None
            else [
                varied_model(model, body, float(friction), float(mass))
                for friction, mass in zip(variation.friction, variation.trunk_mass, strict=True)
            ]
        )
        threads = min(
            len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1, count
        )
        # A pool of no threads runs on the calling one.
        self._pool = rollout.Rollout(nthread=threads if threads > 1 else 0)
        self._scratch = [mujoco.MjData(model) for _ in range(threads)]
        self._sensors = int(model.nsensordata)

    def __len__(self) -> int:
        return len(self.models)

    def step(self, state: BodyState, torques: Float[np.ndarray, "N J"], count: int = 1) -> Stepped:
        """Return what happens in `count` physics steps under constant torques."""
        if torques.shape != (len(self), len(self.body.joints)) or len(state) != len(self):
            raise InputError(
                f"torques of shape {torques.shape} and {len(state)} states are given for"
                f" {len(self)} robots of {len(self.body.joints)} joints"
            )
        full = np.concatenate([state.time[:, None], state.coordinates, state.speeds], axis=1)
        control = np.broadcast_to(torques[:, None], (len(self), count, torques.shape[1]))
        states = np.empty((len(self), count, full.shape[1]))
        sensors = np.empty((len(self), count, self._sensors))
        self._pool.rollout(
            *(self.models, self._scratch, full, np.ascontiguousarray(control)),
            skip_checks=True,  # they cost as much as a tenth of the physics
            nstep=count,
            state=states,
            sensordata=sensors,
        )
        width = state.coordinates.shape[1]
        after = tuple(
            BodyState(each[:, 0], each[:, 1 : 1 + width], each[:, 1 + width :])
            for each in np.moveaxis(states, 1, 0)
        )
        before = after[-2].time if count > 1 else state.time
        return Stepped(after, sensed_from(before, sensors[:, -1]))
