"""Faces with many corners keep their shape."""

import numpy as np
import pytest

from jaxleas.terrain import import_terrain, load_scene
from jaxleas.terrain.meshes.faces import triangulate
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.types import InputError

U = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)]  # 10 m2


def cut(points, faces):
    points = np.array(points, float)
    counts = np.array([len(face) for face in faces])
    corners = np.concatenate([np.array(face) for face in faces])
    return points[triangulate(points, corners, counts, InputError)]


def areas(triangles):
    return 0.5 * np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def obj(path, outline, tilt=0.0):
    lines = [f"v {x} {y} {tilt * x}" for x, y in outline]
    path.write_text("\n".join([*lines, "f " + " ".join(map(str, range(1, len(outline) + 1)))]))
    return path


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("shift", range(8))
def test_a_concave_face_keeps_its_area_and_winding(order, shift):
    outline = np.roll(np.array(U, float), shift, axis=0)[::order]
    triangles = cut(np.column_stack([outline, 0.5 * outline[:, 0]]), [range(8)])
    assert len(triangles) == 6
    assert areas(triangles)[:, 2].sum() == pytest.approx(10.0 * order)
    assert (areas(triangles)[:, 2] * order > 0.0).all()


def test_random_stars_keep_their_area():
    rng = np.random.default_rng(1)
    for count in range(4, 40):
        angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, count))
        if np.diff(angle, append=angle[0] + 2 * np.pi).max() > np.pi:
            continue  # then the middle lies outside
        star = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]) * rng.uniform(
            0.2, 2.0, (count, 1)
        )
        true = polygon_area_vector(star)
        triangles = cut(star, [range(count)])
        assert np.linalg.norm(areas(triangles), axis=1).sum() == pytest.approx(true[2])


def test_quads_are_cut_at_their_inner_corner():
    arrow = [(0, 0, 0), (2, 1, 0), (0, 2, 0), (1, 1, 0)]
    for shift in range(4):
        triangles = cut(np.roll(arrow, shift, axis=0), [range(4)])
        assert np.linalg.norm(areas(triangles), axis=1).sum() == pytest.approx(1.0)


def test_a_face_that_crosses_itself_is_refused():
    with pytest.raises(InputError, match=r"face of 4 corners .* crosses itself"):
        cut([(0, 0, 0), (2, 0, 0), (0, 1, 0), (2, 1.5, 0)], [range(4)])
    star = [(np.cos(a), np.sin(a), 0.0) for a in 4.0 * np.pi * np.arange(5) / 5]
    with pytest.raises(InputError, match="crosses itself"):
        cut(star, [range(5)])


def test_faces_stay_in_order():
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (5, 0, 0), (6, 0, 0), (6, 1, 0)]
    triangles = cut(points, [(0, 1, 2, 3), (4, 5, 6), (0, 1, 2)])
    assert triangles[:, 0, 0].tolist() == [0, 0, 5, 0]


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_map_and_scene_of_a_u_have_its_area(tmp_path, tilt):
    path = obj(tmp_path / "u.obj", U, tilt)
    heights = import_terrain(path, resolution=0.05)
    ground = np.isfinite(heights.heights)
    assert ground.sum() * 0.05**2 == pytest.approx(10.0, rel=0.01)
    scene = load_scene(path)
    flat = sum(polygon_area_vector(each)[2] for each in scene.surfaces.values())
    assert flat == pytest.approx(10.0)
