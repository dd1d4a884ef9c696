"""Limbs that do not stand, such as arms: their mass counts, in their reference posture."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.plan_sampling import plan_sampling
from jaxleas.contacts.posture_limbs import resting_mass
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.geometry import Box, Polytope
from jaxleas.robots import Effector, Limb, Robot, load_robot
from jaxleas.robots.chain import SerialChain
from jaxleas.robots.legs import legs_of
from jaxleas.robots.limb_model import LimbModel
from jaxleas.types.poses import Pose

from .worlds import flat, straight

TALOS = load_robot("talos")


def arm() -> LimbModel:
    """Return two links of 3 and 1 kg: out to y = -0.5 m at shoulder height, then 0.4 m forwards.

    The elbow is turned by a quarter turn in the reference posture, so that the second link's mass,
    0.2 m along its own axis, is ahead of the elbow.
    """
    chain = SerialChain(
        names=("shoulder", "elbow"),
        positions=np.array([[0.0, -0.2, 0.5], [0.0, -0.3, 0.0]]),
        rotations=np.tile(np.eye(3), (2, 1, 1)),
        axes=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]),
        lower=np.array([-2.0, -2.0]),
        upper=np.array([2.0, 2.0]),
        tip=Pose(np.array([0.0, -0.4, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])),
    )
    return LimbModel(
        chain=chain,
        reference=np.array([0.0, np.pi / 2.0]),
        link_mass=np.array([3.0, 1.0]),
        link_com=np.array([[0.0, -0.1, 0.0], [0.0, -0.2, 0.0]]),
        boxes=(),
        capsules=(),
        com_reach=Polytope.from_box(Box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))),
    )


MOMENT = np.array([0.0 + 0.2, 3.0 * -0.3 - 0.5, 3.0 * 0.5 + 0.5])
"""By hand: 3 kg at (0, -0.3, 0.5), and 1 kg at (0.2, -0.5, 0.5) [kg m]."""


@pytest.fixture
def reaching() -> Robot:
    talos = load_robot("talos")
    reach = Polytope.from_box(Box((0.0, -1.0, 0.0), (1.0, 0.0, 1.0)))
    palm = Limb("arm", reach, Effector("RH", "palm", (0.05, 0.04), 0.7), None, arm())
    return replace(talos, limbs=(*talos.limbs, palm))


def test_an_arm_counts_with_the_body_in_planner_and_certificate(reaching: Robot) -> None:
    body = load_robot("talos").body
    assert body is not None
    mass = body.mass + 4.0
    com = (body.mass * body.com + MOMENT) / mass
    planned = legs_of(reaching)
    np.testing.assert_allclose(planned.body.com, com, atol=1e-12)
    assert planned.body.mass == pytest.approx(mass)
    assert planned.mass == pytest.approx(legs_of(load_robot("talos")).mass + 4.0)
    certified, where = resting_mass(reaching, ("LF", "RF"))
    np.testing.assert_allclose(where, com, atol=1e-12)
    assert certified == pytest.approx(mass)


def test_an_arm_without_a_model_weighs_nothing_of_its_own(reaching: Robot) -> None:
    *legs, palm = reaching.limbs
    bare = replace(reaching, limbs=(*legs, replace(palm, model=None)))
    body = load_robot("talos").body
    assert body is not None
    assert legs_of(bare).body is bare.body
    assert resting_mass(bare, ("LF", "RF"))[0] == body.mass


def test_a_plan_of_a_robot_with_an_arm_is_certified(reaching: Robot) -> None:
    settings = SamplingSettings(samples=4000)
    plan = plan_sampling(straight(0.8), flat(), settings, robot=reaching)
    alone = plan_sampling(straight(0.8), flat(), settings, robot=TALOS)
    assert plan.feasible
    assert plan.postures
    assert alone.postures
    leaned = plan.postures[0].com - alone.postures[0].com
    assert leaned[1] < -0.01, "an arm to the right moves the centre of mass to the right"
