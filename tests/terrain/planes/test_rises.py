"""High rises of a map as obstacles of the scene that is found in it."""

import numpy as np
import pytest

from jaxleas.contacts.trunk import trunk_collision
from jaxleas.robots import load_robot
from jaxleas.terrain import HeightMap, Scene, find_surfaces, rasterise
from jaxleas.terrain.loading import scene_of_surfaces
from jaxleas.terrain.planes.report import surfaces_in_words
from jaxleas.terrain.planes.rises import LEAST, rises
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.scene_file import require_valid
from jaxleas.types import GuidePath

CELL = 0.05


def floor(rows=60, columns=100) -> np.ndarray:
    return np.random.default_rng(0).normal(0.0, 0.005, (rows, columns)).astype(np.float32)


def test_a_wall_in_a_map_blocks_the_trunk_and_a_step_does_not() -> None:
    heights = floor()
    heights[:, 50:52] += 1.5
    path = straight(0.5, 4.5)
    robot = load_robot("talos")
    found = find_surfaces(HeightMap(heights, CELL, (0.0, 0.0)))
    scene = scene_of_surfaces(found)
    require_valid(scene, "wall")
    assert trunk_collision(robot, scene, path) is not None
    assert "rises of 0.5 m and more are obstacles" in surfaces_in_words(found)
    heights[:, 50:52] -= 1.5
    heights[:, 50:] += 0.2
    assert not find_surfaces(HeightMap(heights, CELL, (0.0, 0.0))).obstacles


@pytest.mark.parametrize(
    ("place", "outward"),
    [
        ((slice(None), slice(0, 20)), (1, 0)),
        ((slice(None), slice(20, None)), (-1, 0)),
        ((slice(0, 20), slice(None)), (0, 1)),
        ((slice(20, None), slice(None)), (0, -1)),
    ],
)
def test_a_face_is_one_piece_and_looks_to_the_low_side(place, outward) -> None:
    heights = floor(40, 40)
    heights[place] += 2.0 * LEAST
    (face,) = rises(HeightMap(heights, CELL, (3.0, -1.0))).values()
    area = polygon_area_vector(face)
    np.testing.assert_allclose(area[:2] / np.linalg.norm(area), outward, atol=1e-6)
    assert np.linalg.norm(area) == pytest.approx(40 * CELL * 2.0 * LEAST, rel=0.05)
    axis = int(np.argmax(np.abs(outward)))
    np.testing.assert_allclose(face[:, axis], (3.0, -1.0)[axis] + 19.5 * CELL)


def test_holes_are_no_rises_and_unequal_heights_part_a_face() -> None:
    heights = floor(40, 40)
    heights[:20, 20:] += 1.0
    heights[20:, 20:] += 2.0
    heights[5:10, 18:22] = np.nan
    faces = rises(HeightMap(heights, CELL, (0.0, 0.0)))
    along_y = [each for each in faces.values() if np.ptp(each[:, 0]) < 1e-9]
    assert len(along_y) == 3  # below the hole, above it, and the higher part


def test_the_found_scene_has_the_faces_of_a_true_box() -> None:
    square = np.array([[0.0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 3, 0]])
    top = np.array([[1.5, 1.0, 1], [2.5, 1.0, 1], [2.5, 2.0, 1], [1.5, 2.0, 1]])
    found = rises(rasterise(Scene({"floor": square, "top": top}), CELL))
    assert len(found) == 4
    area = sum(np.linalg.norm(polygon_area_vector(each)) for each in found.values())
    assert area == pytest.approx(4.0, rel=0.05)


def straight(start: float, end: float) -> GuidePath:
    x = np.linspace(start, end, 40)
    position = np.column_stack([x, np.full(len(x), 1.5), np.full(len(x), 1.0)])
    return GuidePath(
        time=np.linspace(0.0, 8.0, len(x)),
        position=position,
        yaw=np.zeros(len(x)),
        velocity=np.tile([0.5, 0.0, 0.0], (len(x), 1)),
        valid=np.ones(len(x), bool),
    )
