"""MJCF models and lists of boxes: what stands still, in its place."""

import numpy as np
import pytest
from PIL import Image

from jaxleas.terrain import import_terrain, load_scene
from jaxleas.terrain.polygons import polygon_area_vector, upwardness
from jaxleas.types import InputError

pytest.importorskip("mujoco", reason="needs the extra maps")


def model(path, world, assets="", before="", defaults=""):
    path.write_text(
        f"<mujoco>{before}<asset>{assets}</asset>{defaults}<worldbody>{world}</worldbody></mujoco>"
    )
    return path


def at(path, *points, **stated):
    return import_terrain(path, **stated).height_at(np.array(points, float))


def test_boxes_and_planes_stand_where_bodies_place_them(tmp_path):
    path = model(
        tmp_path / "a.xml",
        """<geom type="plane" size="4 3 .1" pos="0 0 -.1"/>
        <body pos="1 0 0"><frame pos="0 0 .1"><body euler="0 0 90">
        <geom type="box" size=".5 .2 .1" pos="1 0 0"/></body></frame></body>""",
    )
    points = ([1.0, 1.0], [1.15, 1.4], [1.3, 1.0], [-3.9, -2.9], [-4.3, 0.0])
    np.testing.assert_allclose(at(path, *points), [0.2, 0.2, -0.1, -0.1, np.nan], atol=1e-6)
    scene = load_scene(path)
    areas = sorted(polygon_area_vector(each)[2] for each in scene.surfaces.values())
    assert areas == pytest.approx([0.4, 48.0])
    assert len(scene.obstacles) == 4


def test_a_tilted_box_has_its_slope(tmp_path):
    path = model(tmp_path / "a.xml", '<geom type="box" size="1 1 .1" euler="0 20 0"/>')
    (top,) = load_scene(path).surfaces.values()
    assert upwardness(top) == pytest.approx(np.cos(np.radians(20.0)))


def test_meshes_and_height_fields_are_read_with_their_files(tmp_path):
    import trimesh

    (tmp_path / "parts").mkdir()
    place = trimesh.transformations.translation_matrix((0.0, 0.0, 0.1))
    box = trimesh.creation.box(extents=(1.0, 1.0, 0.2), transform=place)
    box.export(tmp_path / "parts" / "block.stl")
    levels = np.zeros((3, 5), np.uint8)
    levels[0, 4] = 255  # the upper right pixel: largest x, largest y
    Image.fromarray(levels).save(tmp_path / "parts" / "field.png")
    path = model(
        tmp_path / "a.xml",
        """<geom type="mesh" mesh="block" pos="5 0 0"/><geom type="hfield" hfield="field"/>""",
        """<mesh file="block.stl"/><mesh name="robot" file="missing.stl"/>
        <hfield name="field" file="field.png" size="2 1 .5 .1"/>
        <texture name="t" type="2d" file="none.png"/><material name="m" texture="t"/>""",
        '<compiler meshdir="parts"/>',
    )
    points = ([5.0, 0.0], [1.99, 0.99], [1.99, -0.99], [-1.0, 0.0], [1.5, 0.5])
    np.testing.assert_allclose(at(path, *points), [0.2, 0.49, 0.0, 0.0, 0.25], atol=0.03)


def test_what_moves_or_touches_nothing_or_is_missing_is_left_out_and_said(tmp_path, caplog):
    (tmp_path / "ground.xml").write_text(
        '<mujoco><worldbody><geom type="box" size="1 1 .1" pos="0 0 -.1"/></worldbody></mujoco>'
    )
    path = model(
        tmp_path / "a.xml",
        """<body pos="0 0 1"><freejoint/><geom type="mesh" mesh="r"/></body>
        <body mocap="true"><geom type="box" size="9 9 9"/></body>
        <geom class="seen" type="box" size="5 5 5"/><light pos="0 0 3"/>
        <body><geom type="cylinder" size=".2 .1" pos="0 0 .1"/></body>""",
        '<mesh name="r" file="robot.stl"/>',
        '<include file="robot.xml"/><include file="ground.xml"/>'
        '<actuator><motor joint="q"/></actuator>',
        """<default><geom material="m"/><default class="seen">
        <geom contype="0" conaffinity="0"/></default></default>""",
    )
    np.testing.assert_allclose(at(path, [0.0, 0.0], [0.5, 0.5]), [0.2, 0.0], atol=1e-6)
    for said in ("robot.xml, which is missing", "2 bodies that move", "1 geoms that touch nothing"):
        assert said in caplog.text


def test_an_endless_plane_ends_around_everything_else(tmp_path, caplog):
    world = '<geom type="plane" size="0 0 1"/>'
    alone = import_terrain(model(tmp_path / "a.xml", world))
    assert alone.extent == pytest.approx((-5.1, 5.1, -5.1, 5.1), abs=0.05)
    world += '<geom type="box" size="1 1 .1" pos="9 0 0"/>'
    both = import_terrain(model(tmp_path / "a.xml", world))
    assert both.extent == pytest.approx((6.9, 11.1, -2.1, 2.1), abs=0.05)
    assert "has an endless plane" in caplog.text


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("", "is not XML"), ("<robot/>", "root <robot>"),
        ("<mujoco/>", "nothing that stands still"),
        ("<mujoco><worldbody><geom type='mesh' mesh='m'/></worldbody></mujoco>",
         "no model that MuJoCo"),
        ("<mujoco><asset><mesh name='m' file='../../etc/passwd'/></asset><worldbody>"
         "<geom type='mesh' mesh='m'/></worldbody></mujoco>", "which is not in its folder"),
        ("<mujoco><include file='a.xml'/></mujoco>", "includes more than 100 files"),
        ('<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa">' + "".join(
            f'<!ENTITY {y} "{f"&{x};" * 10}">' for x, y in zip("abcdefgh", "bcdefghi", strict=True)
        ) + "]><mujoco>&i;</mujoco>", "is not XML"),
    ],
)  # fmt: skip
def test_what_is_no_model_is_refused(tmp_path, content, problem):
    (tmp_path / "a.xml").write_text(content)
    with pytest.raises(InputError, match=problem):
        import_terrain(tmp_path / "a.xml")


STONES = """stones:
  # [centre of the top, normal, dimensions, yaw]
  - [[0, 0, 0], [0, 0, 1.0], [2.0, 2.5, 0.2], [0]]
  - [[1.5, -0.8, 0.1], [0.0, 0.0, 2.0], [0.4, 0.2, 0.3], [1.5707963267948966]]
  - [[3, 0, 0.5], [-0.3, 0.4, 1], [1, 1, 0.3], [0.2]]
"""


def test_a_list_of_stones_has_their_tops_and_slopes(tmp_path):
    (tmp_path / "stones.yaml").write_text(STONES)
    scene = load_scene(tmp_path / "stones.yaml")
    level, turned, tilted = scene.surfaces.values()
    np.testing.assert_allclose(np.ptp(level, axis=0), [2.0, 2.5, 0.0], atol=1e-9)
    np.testing.assert_allclose(np.ptp(turned, axis=0), [0.2, 0.4, 0.0], atol=1e-9)
    assert turned[0, 2] == pytest.approx(0.1)
    normal = polygon_area_vector(tilted)
    assert np.linalg.norm(normal) == pytest.approx(1.0)
    np.testing.assert_allclose(normal, np.array([-0.3, 0.4, 1.0]) / np.sqrt(1.25), atol=1e-9)
    np.testing.assert_allclose(tilted.mean(axis=0), [3.0, 0.0, 0.5], atol=1e-9)


def test_boxes_may_have_names_for_their_parts(tmp_path):
    (tmp_path / "a.yaml").write_text(
        "boxes:\n  - {centre: [0, 0, 0], size: [1, 1, 0.2]}\n"
        "  - {top: [2, 0, 0], size: [1, 1, 1], yaw: 0.1}\n"
    )
    np.testing.assert_allclose(at(tmp_path / "a.yaml", [0, 0], [2, 0]), [0.1, 0.0], atol=1e-6)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("a: 1", "has 0 lists"), ("a: [1]\nb: [2]", "has 2 lists"), ("a: []", "0 boxes"),
        ("a: [1]", "box 0 of 'a' is no"),
        ("a: [[[0, 0], [0, 0, 1], [1, 1, 1], [0]]]", "should be 3 numbers"),
        ("a: [[[0, 0, 0], [0, 0, 0], [1, 1, 1], [0]]]", "normal that is not 0"),
        ("a: [{size: [1, 1, 1]}]", "either 'top' or 'centre'"),
        ("a: [{sise: [1, 1, 1]}]", "unknown key 'sise'"),
        ("a: [[[0, 0, .inf], [0, 0, 1], [1, 1, 1], [0]]]", "beyond 1000 km"),
    ],
)  # fmt: skip
def test_what_is_no_list_of_boxes_is_refused(tmp_path, content, problem):
    (tmp_path / "a.yaml").write_text(content)
    with pytest.raises(InputError, match=problem):
        import_terrain(tmp_path / "a.yaml")
