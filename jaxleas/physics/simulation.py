"""Physics of a batch of robots: one `step`, behind which stand threads of MuJoCo."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from jaxleas.physics.bodies import FREE_JOINT, Body
from jaxleas.physics.mujoco_extra import import_mujoco
from jaxleas.physics.state import ROOT_SPEEDS, BodyState, Sensed
from jaxleas.physics.variation import Variation
from jaxleas.physics.world import world_mjcf
from jaxleas.terrain import Scene
from jaxleas.types import InputError, quaternion_about_z


@dataclass(frozen=True, eq=False)
class Stepped:
    """What happened in some physics steps.

    Attributes:
        states: state after each physics step, K of them; the last one is now.
        sensed: measurements at the state before the last one: MuJoCo evaluates its sensors at the
            beginning of a step.
    """

    states: tuple[BodyState, ...]
    sensed: Sensed

    @property
    def state(self) -> BodyState:
        """The state now."""
        return self.states[-1]


class Physics(Protocol):
    """A simulator of N copies of a robot in one world.

    Attributes:
        body: robot.
        mjcf: text of the world that was compiled.
    """

    body: Body
    mjcf: str

    def __len__(self) -> int:
        """Return the number of robots."""
        ...

    def step(self, state: BodyState, torques: Float[np.ndarray, "N J"], count: int = 1) -> Stepped:
        """Return what happens in `count` physics steps under constant torques.

        Args:
            state: state to begin from.
            torques: torques of the joints, kept within the motors' limits [Nm].
            count: number of physics steps.
        """
        ...


def make_physics(
    body: Body,
    count: int,
    scene: Scene | None = None,
    variation: Variation | None = None,
) -> Physics:
    """Return a simulator of `count` copies of a robot.

    Args:
        body: robot.
        count: number of robots; they do not meet each other.
        scene: scene that they walk on; None for level ground.
        variation: how each robot differs from its file; None for not at all.

    Raises:
        InputError: the scene is no world for MuJoCo, or the variation is of another number of
            robots.
        NoPhysicsError: MuJoCo is not installed.
    """
    if variation is not None and len(variation) != count:
        raise InputError(f"a variation of {len(variation)} robots is given for {count} robots")
    mjcf = world_mjcf(body, scene)
    mujoco = import_mujoco()
    try:
        model = mujoco.MjModel.from_xml_string(mjcf)
    except ValueError as error:
        raise InputError(f"the scene is no world for MuJoCo: {error}") from error
    from jaxleas.physics.threads import ThreadedPhysics

    return ThreadedPhysics(body, mjcf, model, count, variation)


def standing(
    body: Body, places: Float[np.ndarray, "N 3"], yaws: Float[np.ndarray, " N"] | float = 0.0
) -> BodyState:
    """Return the states of robots that stand at rest.

    Args:
        body: robot.
        places: points of the ground under the roots [m].
        yaws: headings [rad].
    """
    count = len(places)
    coordinates = np.empty((count, FREE_JOINT + len(body.standing)))
    coordinates[:, :3] = places + np.array([0.0, 0.0, body.standing_height])
    coordinates[:, 3:FREE_JOINT] = quaternion_about_z(np.broadcast_to(yaws, (count,)))
    coordinates[:, FREE_JOINT:] = body.standing
    return BodyState(
        np.zeros(count), coordinates, np.zeros((count, ROOT_SPEEDS + len(body.standing)))
    )
