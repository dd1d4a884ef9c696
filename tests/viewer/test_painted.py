import io
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from jaxleas.viewer.painted import SUN, flat, glb_of, joined, shade
from jaxleas.viewer.ribbon import MOST_PIECES, PIECE, WIDTH, Trail, mesh_of_path
from jaxleas.viewer.terrain_mesh import Mesh

WHITE = np.array([255.0, 255.0, 255.0])


def square(normal: int, side: float = 1.0) -> Mesh:
    """A square whose normal is an axis, seen counter-clockwise from that axis."""
    corners = np.zeros((4, 3))
    corners[:, (normal + 1) % 3] = [0.0, side, side, 0.0]
    corners[:, (normal + 2) % 3] = [0.0, 0.0, side, side]
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))


def test_another_reader_finds_the_same_triangles_and_colours():
    trimesh = pytest.importorskip("trimesh")
    mesh = joined([square(0), square(2)])
    grey = np.full((8, 3), 188.0)  # in sRGB; half of the light
    grey[4:] = [255.0, 0.0, 0.0]
    content = glb_of(mesh, grey, opacity=0.5)
    assert b"KHR_materials_unlit" in content
    assert b'"alphaMode":"BLEND"' in content
    assert int.from_bytes(content[8:12], "little") == len(content)
    (read,) = trimesh.load(io.BytesIO(content), file_type="glb", process=False).geometry.values()
    np.testing.assert_allclose(read.vertices, mesh.vertices)
    np.testing.assert_array_equal(read.faces, mesh.faces)
    paint = np.asarray(read.visual.vertex_attributes["color"], np.float64) / 65535.0
    np.testing.assert_allclose(paint[:4, :3], 0.5, atol=0.005)
    np.testing.assert_allclose(paint[4:], np.tile([1.0, 0.0, 0.0, 1.0], (4, 1)))


def test_the_light_falls_from_above_and_from_the_south_west():
    light = {axis: shade(square(axis), WHITE)[0, 0] for axis in range(3)}
    assert light[2] > light[0] > 0.0  # the sun stands behind a face that looks east
    west = Mesh(square(0).vertices, square(0).faces[:, ::-1])
    assert light[2] > shade(west, WHITE)[0, 0] > light[0]
    below = Mesh(square(2).vertices, square(2).faces[:, ::-1])
    assert shade(below, WHITE).max() < light[0]
    assert SUN[2] > 0.0 > SUN[0]


def test_a_flat_mesh_has_one_shade_a_triangle():
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    cube = flat(Mesh(corners, ConvexHull(corners).simplices))
    colours = shade(cube, WHITE).reshape(-1, 3, 3)
    np.testing.assert_array_equal(colours[:, 0], colours[:, 1])
    np.testing.assert_array_equal(colours[:, 0], colours[:, 2])
    assert len(np.unique(colours[:, 0, 0])) > 3


def test_a_ribbon_follows_its_path_with_its_width_even_where_nobody_moves():
    path = np.array([[0, 0, 1], [0, 0, 1], [0, 0, 1], [0.1, 0, 1], [0.1, 0, 1.2], [0.1, 0.3, 1]])
    mesh = mesh_of_path(path)
    assert np.isfinite(mesh.vertices).all()
    left, right, over, under = mesh.vertices.reshape(4, -1, 3)
    for one, other in ((left, right), (over, under)):
        np.testing.assert_allclose(0.5 * (one + other), path, atol=1e-12)
        np.testing.assert_allclose(np.linalg.norm(one - other, axis=1), WIDTH)
    assert np.abs(left[:3, 1]).min() == pytest.approx(0.5 * WIDTH)  # across the way it will go
    assert sorted(np.unique(mesh.faces)) == list(range(len(mesh.vertices)))
    standing = mesh_of_path(np.ones((3, 3)))
    assert np.isfinite(standing.vertices).all()


def test_only_the_last_piece_of_a_trail_is_drawn_again_and_the_oldest_go():
    drawn, removed = [], []
    scene = SimpleNamespace(
        add_glb=lambda name, content, **_: drawn.append(name), remove_by_name=removed.append
    )
    trail = Trail(SimpleNamespace(scene=scene), "/trail", (1, 2, 3))  # type: ignore[arg-type]
    trail.begin(np.zeros(3))
    count = (MOST_PIECES + 2) * PIECE
    for step in range(count):
        trail.add(np.array([0.01 * (step + 1), 0.0, 1.0]))
    assert drawn == [f"/trail/{index}" for index in range(MOST_PIECES + 2)]
    assert {"/trail/0", "/trail/1"} <= set(removed)
    trail.draw()
    assert len(drawn) == MOST_PIECES + 2  # nothing new to see
    trail.add(np.array([100.0, 0.0, 1.0]))
    trail.draw()
    assert drawn[-1] == f"/trail/{MOST_PIECES + 2}"
    trail.begin(np.zeros(3))
    assert removed[-1] == "/trail"
