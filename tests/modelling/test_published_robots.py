"""Talos and G1 come out again from their options; other published robots can be made."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.conditions import collision, reachability, strict_reachability
from jaxleas.configuration import load_config
from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.modelling.making import standing_of
from jaxleas.modelling.options import MakeOptions
from jaxleas.modelling.sampling import draw_standing
from jaxleas.modelling.sketch import sketch_robot
from jaxleas.robots import load_robot, read_robot
from jaxleas.terrain import GeneratorConfig, generate_arena, rasterise, scale_for, scaled
from tests.robots.urdfs import ANYMAL_B, G1, TALOS, published
from tests.test_docs import ROOT

DATA = ROOT / "jaxleas/robots/data"


@pytest.mark.slow
@pytest.mark.parametrize(("name", "urdf"), [("talos", TALOS), ("g1", G1)])
def test_the_options_beside_a_file_make_it_again(name, urdf, tmp_path):
    out = tmp_path / "made.json"
    options = str(DATA / f"{name}.yaml")
    cli.run(["robot", "make", str(published(urdf)), "--options", options, "--out", str(out)])
    made, shipped = read_robot(out), load_robot(name)
    for one, other in zip(made.limbs, shipped.limbs, strict=True):
        mine, theirs = one.range_of_motion, other.range_of_motion
        for normals in (mine.normals, theirs.normals):
            apart = reach(mine, normals) - reach(theirs, normals)
            assert np.abs(apart).max() < 0.01
        np.testing.assert_array_equal(one.model.reference, other.model.reference)
        np.testing.assert_allclose(one.model.link_mass, other.model.link_mass)
        apart = one.model.com_reach.offsets - other.model.com_reach.offsets
        assert np.abs(apart).max() < 1e-4
    assert made.body.mass == shipped.body.mass
    np.testing.assert_array_equal(made.body.com, shipped.body.com)
    for condition in (reachability, strict_reachability, collision):
        points, heights = looked_at(shipped)
        held = [
            np.asarray(condition(each, points)(heights, None)) > 0.0 for each in (made, shipped)
        ]
        assert 0.5 < held[1].mean() < 0.9999
        assert (held[0] == held[1]).mean() >= 0.999


def reach(polytope, normals) -> np.ndarray:
    return (polytope.vertices @ normals.T).max(axis=0)


def looked_at(robot) -> tuple[np.ndarray, np.ndarray]:
    """Return points, and heights there that 10,000 random configurations see."""
    points = np.asarray(SteeringEnv(SteeringConfig.for_robot(robot.name)).points_in_root)
    arena = generate_arena(seed=5, config=scaled(GeneratorConfig(), scale_for(robot)))
    ground, rng = rasterise(arena.scene), np.random.default_rng(0)
    rows, columns = np.nonzero(np.isfinite(ground.heights))
    some = rng.choice(len(rows), 10_000)
    yaw, (low, high) = rng.uniform(-np.pi, np.pi, (10_000, 1)), robot.start_heights
    above = robot.walking_height + rng.uniform(low - 0.05, high + 0.05, 10_000)
    x, y = points.T / ground.resolution
    column = np.round(columns[some, None] + np.cos(yaw) * x - np.sin(yaw) * y).astype(int)
    row = np.round(rows[some, None] + np.sin(yaw) * x + np.cos(yaw) * y).astype(int)
    height, width = ground.heights.shape
    inside = (row >= 0) & (row < height) & (column >= 0) & (column < width)
    seen = ground.heights[np.clip(row, 0, height - 1), np.clip(column, 0, width - 1)]
    seen = seen - (ground.heights[rows[some], columns[some]] + above)[:, None]
    return points, np.where(inside & np.isfinite(seen), seen, -1e4).astype(np.float32)


def test_a_quadruped_stands_on_four_points_in_the_order_of_the_house():
    said: list[str] = []
    options = MakeOptions(feet=("RH_FOOT", "LF_FOOT", "RF_FOOT", "LH_FOOT"))
    sketch = sketch_robot(published(ANYMAL_B), options, said.append)
    legs = sketch.stance.legs
    assert [leg.foot for leg in legs] == ["LF", "RF", "LH", "RH"]
    assert [leg.link for leg in legs] == ["LF_FOOT", "RF_FOOT", "LH_FOOT", "RH_FOOT"]
    assert [leg.mirror_of for leg in legs] == [None, 0, None, 2]
    assert not any(leg.flat for leg in legs)
    assert sketch.masses.total == pytest.approx(30.475, abs=0.01)
    assert any("in the order LF_FOOT RF_FOOT LH_FOOT RH_FOOT" in each for each in said)
    soles = np.array([leg.sole for leg in legs])
    np.testing.assert_allclose(soles[:, 2], -sketch.stance.height, atol=1e-3)


@pytest.mark.parametrize(("name", "urdf"), [("talos", TALOS), ("g1", G1)])
def test_fresh_samples_of_the_urdf_lie_in_the_shipped_polytope(name, urdf):
    options = load_config(MakeOptions, DATA / f"{name}.yaml")
    sketch = sketch_robot(published(urdf), options, print)
    leg = sketch.stance.legs[0]
    chain, ground = leg.bent(options.least_bend), standing_of(sketch, leg, options)
    standing = draw_standing(chain, ground, 200_000, 99, lambda _: None).soles
    assert len(standing) > 2000
    polytope = load_robot(name).limbs[0].range_of_motion
    # Other samples than the maker's reach a few millimetres further here and there.
    inside = [polytope.contains(standing, t).mean() for t in (0, 0.005, 0.02)]
    assert inside[0] > 0.99
    assert inside[1] > 0.999
    assert inside[2] == 1.0
