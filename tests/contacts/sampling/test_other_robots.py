"""The sampling-based planner with a robot that is not Talos."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.plan_sampling import plan_sampling
from jaxleas.contacts.posture_certificate import certify_postures
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.robots import load_robot
from jaxleas.types import GuidePath, InputError

from .worlds import stairs, straight


def lowered(path: GuidePath, by: float) -> GuidePath:
    return replace(path, position=path.position - np.array([0.0, 0.0, by]))


def test_g1_climbs_stairs_as_its_own_legs_allow() -> None:
    robot, scene = load_robot("g1"), stairs()
    guide = lowered(straight(3.0, climbing=True), 0.2)  # from Talos's height to G1's
    plan = plan_sampling(guide, scene, SamplingSettings(samples=8000), robot=robot)
    assert plan.feasible
    assert plan.postures
    assert plan.postures[-1].feet["LF"].position[2] > 0.3
    certificate = certify_postures(plan, guide, scene, robot)
    assert certificate.certified, certificate.complaint
    with_talos = certify_postures(plan, guide, scene, load_robot("talos"))
    assert "posture" in with_talos.complaint, "the same postures are none of Talos"


def test_a_robot_without_legs_in_its_file_is_refused() -> None:
    robot = replace(load_robot("g1"), body=None)
    with pytest.raises(InputError, match="the file of robot 'g1' has no 'body'"):
        plan_sampling(straight(1.0), stairs(), robot=robot)
