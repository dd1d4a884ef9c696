"""The inverse kinematics of limbs that no closed form knows."""

import numpy as np
import pytest
from test_chain import draw, toy
from urdfs import G1, PANDA, TALOS, published

from jaxleas.geometry import Box, Polytope
from jaxleas.robots import load_talos
from jaxleas.robots.chain import SerialChain, chain_posture
from jaxleas.robots.limb_model import LimbModel
from jaxleas.robots.numeric_inverse import draw_starts, numeric_inverse
from jaxleas.robots.spherical_leg import SphericalLeg
from jaxleas.robots.urdf import read_chain


def limb(chain: SerialChain) -> LimbModel:
    count = len(chain)
    reach = Polytope.from_box(Box((-1.0, -1.0, 0.0), (1.0, 1.0, 1.0)))
    middle = 0.5 * (chain.lower + chain.upper)
    return LimbModel(chain, middle, np.ones(count), np.zeros((count, 3)), (), (), reach)


@pytest.mark.parametrize(
    ("urdf", "root", "link"),
    [(G1, "pelvis", "left_ankle_roll_link"), (PANDA, "panda_link0", "panda_hand")],
)
def test_poses_that_a_limb_has_are_found_again(urdf: str, root: str, link: str) -> None:
    model = limb(read_chain(published(urdf), root, link))
    assert SphericalLeg.of(model.chain) is None
    posture = model.posture(draw(model.chain, 400))
    angles, reached = model.inverse(posture.tip, posture.tip_rotation)
    assert reached.mean() > 0.9  # a search from a few starts may miss some
    assert (angles >= model.chain.lower).all()
    assert (angles <= model.chain.upper).all()
    again = model.posture(angles[reached])
    np.testing.assert_allclose(again.tip, posture.tip[reached], atol=1e-8)
    np.testing.assert_allclose(again.tip_rotation, posture.tip_rotation[reached], atol=1e-8)


def test_poses_out_of_reach_are_not_reached() -> None:
    model = limb(read_chain(published(G1), "pelvis", "left_ankle_roll_link"))
    far = np.array([[0.0, 0.1, -2.0], [3.0, 0.0, -0.6]])
    angles, reached = model.inverse(far, np.tile(np.eye(3), (2, 1, 1)))
    assert not reached.any()
    assert np.isfinite(angles).all()


def test_the_search_agrees_with_the_closed_form() -> None:
    left = load_talos().limbs[0].model
    chain = read_chain(published(TALOS), "base_link", "leg_left_6_link", left.chain.tip)
    assert SphericalLeg.of(chain) is not None
    posture = chain_posture(
        chain, np.random.default_rng(0).uniform(chain.lower, chain.upper, (500, 6))
    )
    exact, in_reach = left.inverse(posture.tip, posture.tip_rotation)
    starts = draw_starts(chain, left.reference)
    found, reached = numeric_inverse(chain, starts, posture.tip, posture.tip_rotation)
    assert reached[in_reach].mean() > 0.95
    both = reached & in_reach
    apart = np.abs(found - exact)[both].max(axis=1)
    assert (apart < 1e-6).mean() > 0.9  # elsewhere there are two solutions


def test_a_limb_of_few_joints_reaches_for_the_position_alone() -> None:
    model = limb(toy(3, 4))
    posture = model.posture(draw(model.chain, 200))
    other = np.tile(np.eye(3), (200, 1, 1))
    angles, reached = model.inverse(posture.tip, other)
    assert reached.mean() > 0.9
    np.testing.assert_allclose(model.posture(angles[reached]).tip, posture.tip[reached], atol=1e-8)


def test_one_pose_or_any_batch() -> None:
    model = limb(toy(6, 1))
    posture = model.posture(draw(model.chain, 6).reshape(2, 3, 6))
    many, reached = model.inverse(posture.tip, posture.tip_rotation)
    one, alone = model.inverse(posture.tip[1, 2], posture.tip_rotation[1, 2])
    assert (many.shape, reached.shape) == ((2, 3, 6), (2, 3))
    np.testing.assert_allclose(one, many[1, 2], atol=1e-12)
    assert alone == reached[1, 2]
