"""Feelers: their margins beside a twin in NumPy, their mirror images, and what they tell apart."""

import numpy as np

from jaxleas.conditions import outline_points
from jaxleas.envs.steering.feelers import MOST_FELT, points_to_feel
from jaxleas.envs.steering.layout import FEELERS169
from jaxleas.robots import load_robot
from jaxleas.terrain import HeightMap, make_atlas
from jaxleas.types import RootMotion

from . import compiled
from .worlds import route_to

ENV = compiled.steering_env(observation="feelers169", outline_spacing=0.05)
MOVES = FEELERS169.feelers
RESOLUTION = 0.04


def rough_map(seed=0, cells=150):
    """Blocks of several heights, thin walls, and holes."""
    rng = np.random.default_rng(seed)
    heights = np.kron(rng.uniform(0.0, 0.15, (15, 15)), np.ones((10, 10))).astype(np.float32)
    for _ in range(12):
        row, column = rng.integers(0, cells - 30, 2)
        heights[row, column : column + 25] = rng.uniform(0.3, 1.5)
        heights[row + 4 : row + 12, column + 3 : column + 8] = np.nan
    return HeightMap(heights, RESOLUTION, (-3.0, -3.0))


def motions(count=60, seed=1):
    rng = np.random.default_rng(seed)
    position = np.column_stack([rng.uniform(-2, 2, (count, 2)), rng.uniform(0.8, 1.1, count)])
    return at_rest(position, rng.uniform(-np.pi, np.pi, count))


def at_rest(position, yaw):
    position = np.asarray(position, np.float32)
    return RootMotion(position, np.zeros_like(position), np.asarray(yaw, np.float32))


def twin_margin(robot, heights, points):
    """R* and C from the inequalities of the polytopes and the corners of the boxes."""
    reaches, free = [], []
    for (x, y), height in zip(points, heights, strict=True):
        if max(abs(x), abs(y)) <= 0.1 + 1e-6:
            for limb in robot.legs:
                normals, offsets = limb.range_of_motion.normals, limb.range_of_motion.offsets
                room = offsets - normals[:, 0] * x - normals[:, 1] * y
                up = normals[:, 2]
                flat = np.abs(up) < 1e-12
                if (room[flat] < 0.0).any():
                    continue
                high = min(room[up > 1e-12] / up[up > 1e-12], default=np.inf)
                low = max(room[up < -1e-12] / up[up < -1e-12], default=-np.inf)
                if low <= high:
                    reaches.append(min(height - low, high - height))
        for box in robot.trunk:
            if all(
                low - 1e-6 <= each <= high + 1e-6
                for each, low, high in zip((x, y), box.low[:2], box.high[:2], strict=True)
            ):
                free.append(box.low[2] - height)
    return min(max(reaches), *free)


def test_margins_are_those_of_a_twin():
    height_map, motion = rough_map(), motions()
    atlas = make_atlas([height_map])
    felt = _look(atlas, motion)[:, -len(MOVES) :]
    points = [points_to_feel(ENV.robot, move) for move in MOVES]
    agree = []
    for robot, (x, y, z) in enumerate(np.asarray(motion.position, np.float64)):
        for feeler, ((ahead, left, turn), own) in enumerate(zip(MOVES, points, strict=True)):
            yaw = float(motion.yaw[robot])
            to_world = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
            middle = np.array([x, y]) + np.array([ahead, left]) @ to_world
            turned = yaw + turn
            about = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
            heights = height_map.height_at(middle + own @ about).astype(np.float64) - z
            heights = np.where(np.isfinite(heights), heights, -1e4)
            expected = np.clip(twin_margin(ENV.robot, heights, own), -MOST_FELT, MOST_FELT)
            agree.append(abs(expected - felt[robot, feeler]) < 2e-5)
    assert len(agree) == 60 * len(MOVES)
    assert np.mean(agree) > 0.995  # a point on the edge between two cells may fall into either


def test_looking_equals_observing_the_local_heights():
    atlas, motion = make_atlas([rough_map()]), motions()
    seen = compiled.observe_local_heights(ENV, atlas, _state(motion))
    np.testing.assert_allclose(_look(atlas, motion), seen, atol=1e-5)


def test_the_first_values_are_those_of_the_layout_without_feelers():
    atlas, motion = make_atlas([rough_map()]), motions()
    seen = compiled.observe_local_heights(compiled.steering_env(), atlas, _state(motion))
    np.testing.assert_allclose(_look(atlas, motion)[:, :144], seen, atol=1e-5)


def test_a_mirrored_world_is_felt_as_the_mirror_image():
    """The map is mirrored in y = 0, cell by cell, and so is the robot."""
    height_map, motion = rough_map(3), motions(seed=4)
    y = height_map.origin[1] + RESOLUTION * (height_map.heights.shape[0] - 1)
    image = HeightMap(height_map.heights[::-1].copy(), RESOLUTION, (height_map.origin[0], -y))
    position = motion.position * np.float32([[1.0, -1.0, 1.0]])
    mirrored = RootMotion(position, motion.velocity, -motion.yaw)
    seen = _look(make_atlas([height_map]), motion, goal=(1.0, 1.0))
    other = _look(make_atlas([image]), mirrored, goal=(1.0, -1.0))
    expected = seen[:, FEELERS169.mirror_permutation] * FEELERS169.mirror_sign
    assert np.mean(np.abs(other - expected) < 1e-4) > 0.995  # edges of cells, as above
    permutation = FEELERS169.mirror_permutation
    np.testing.assert_array_equal(permutation[permutation], np.arange(FEELERS169.size))


def test_the_layout_adds_at_most_forty_numbers():
    assert 144 < FEELERS169.size <= 184
    assert ENV.config.signature().size == FEELERS169.size


def test_a_gap_of_12_cm_is_told_from_one_of_20():
    """At any distance up to 15 cm before the edge, turned or not."""
    offset, turn = (each.ravel() for each in np.meshgrid(np.linspace(0.0, 0.14, 8), [0.0, 0.6]))
    motion = at_rest(np.stack([-0.1 - offset, 0.0 * turn, 0.95 + 0.0 * turn], axis=-1), turn)
    narrow, wide = (
        _look(make_atlas([_with_gap(width)]), motion, goal=(2.0, 0.0)) for width in (0.12, 0.20)
    )
    assert (np.abs(narrow - wide).max(axis=1) > 0.1).all()


def _with_gap(width):
    """Level ground with a gap of this width from x = 0 on, in cells of 2 cm."""
    x = np.arange(-100, 100) * 0.02 + 0.01
    row = np.where((x > 0.0) & (x < width), np.nan, 0.0).astype(np.float32)
    return HeightMap(np.tile(row, (200, 1)), 0.02, (float(x[0]), -2.0))


def test_the_outline_leaves_no_way_in():
    """Points along the trunk's front are close to each other, up to both of its corners."""
    robot = load_robot("talos")
    points = outline_points(robot, 0.05)
    assert len(points) == len({tuple(each) for each in points})
    lower = min(robot.trunk, key=lambda box: box.low[2])
    front = np.sort(points[np.isclose(points[:, 0], lower.high[0])][:, 1])
    assert np.diff(front).max() <= 0.05 + 1e-9
    np.testing.assert_allclose(front[[0, -1]], [lower.low[1], lower.high[1]])
    image = {tuple(np.round(each * [1, -1], 9) + 0.0) for each in points}
    assert image == {tuple(np.round(each, 9) + 0.0) for each in points}


def test_a_post_that_passes_between_the_usual_points_is_met():
    """A post of one cell at the trunk's front edge, where the points are 10 cm apart."""
    heights = np.zeros((100, 100), np.float32)
    heights[51, 53] = 1.5  # x = 0.12, y = 0.04
    atlas = make_atlas([HeightMap(heights, RESOLUTION, (-2.0, -2.0))])
    motion, index = at_rest([[0.0, 0.0, 0.95]], [0.0]), np.zeros(1, np.int32)
    assert compiled.margin(compiled.steering_env(), atlas, index, motion) > 0.0
    assert compiled.margin(ENV, atlas, index, motion) < 0.0


def _state(motion, goal=(1.0, 1.0)):
    return compiled.start(ENV, motion, route_to(goal, len(motion.yaw)))


def _look(atlas, motion, goal=(1.0, 1.0)):
    return np.asarray(compiled.look(ENV, atlas, _state(motion, goal)))
