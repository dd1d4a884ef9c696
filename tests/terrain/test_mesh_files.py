"""Mesh files of every format, and what people's programs do to them."""

import numpy as np
import pytest
import trimesh

from jaxleas.terrain import import_terrain, load_scene
from jaxleas.terrain.meshes.triangles import read_triangles
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.types import InputError

U = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)]  # 10 m2


@pytest.fixture
def steps():
    parts = [((2.0, 2.0, 0.1 * at), (2.0 * at, 1.0, 0.05 * at)) for at in (1, 2, 3)]
    place = trimesh.transformations.translation_matrix
    return trimesh.util.concatenate(
        [trimesh.creation.box(extents=size, transform=place(at)) for size, at in parts]
    )


def sorted_triangles(triangles):
    return triangles[np.lexsort(np.round(triangles.reshape(-1, 9), 4).T)]


@pytest.mark.parametrize(
    ("suffix", "options"),
    [(".ply", {}), (".ply", {"encoding": "ascii"}), (".off", {}), (".obj", {}), (".stl", {})],
)
def test_every_format_has_the_same_triangles(tmp_path, steps, suffix, options):
    steps.export(tmp_path / f"steps{suffix}", **options)
    found = read_triangles(tmp_path / f"steps{suffix}")
    np.testing.assert_allclose(
        sorted_triangles(found), sorted_triangles(np.asarray(steps.triangles)), atol=1e-6
    )
    heights = import_terrain(tmp_path / f"steps{suffix}")
    assert heights.height_at(np.array([[2, 1], [4, 1], [6.4, 1.4]])) == pytest.approx(
        [0.1, 0.2, 0.3]
    )


@pytest.mark.parametrize("up", [None, "y"])
def test_a_glb_is_y_up_as_its_standard_says(tmp_path, steps, up):
    turned = steps.copy()
    turned.apply_transform(trimesh.transformations.rotation_matrix(-0.5 * np.pi, [1, 0, 0]))
    turned.export(tmp_path / "steps.glb")
    heights = import_terrain(tmp_path / "steps.glb", up=up)
    assert heights.height_at(np.array([[2, 1], [4, 1], [6.4, 1.4]])) == pytest.approx(
        [0.1, 0.2, 0.3]
    )


def test_a_glb_that_lies_flat_with_z_up_is_read_so_and_this_is_said(tmp_path, steps, caplog):
    scene = trimesh.Scene()
    scene.add_geometry(steps, transform=trimesh.transformations.translation_matrix((1, 0, 0.5)))
    scene.export(tmp_path / "steps.glb")
    heights = import_terrain(tmp_path / "steps.glb")
    assert heights.height_at(np.array([[3, 1], [5, 1]])) == pytest.approx([0.6, 0.7])
    assert "lie flat with z up, against the format" in caplog.text


def ply(layout, points, faces, number="float", size="uchar"):
    head = [
        "ply", f"format {layout} 1.0", "comment made by hand", f"element vertex {len(points)}",
        *(f"property {number} {axis}" for axis in "xyz"), "property uchar red",
        f"element face {len(faces)}", f"property list {size} int vertex_indices",
        "property uchar flag", "element edge 1", "property int vertex1", "end_header", "",
    ]  # fmt: skip
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(layout)
    if order is None:
        body = "".join(f"{x} {y} {z} 7\n" for x, y, z in points)
        body += "".join(f"{len(face)} {' '.join(map(str, face))} 1\n" for face in faces)
        return ("\n".join(head) + body + "3\n").encode()
    kinds = {"float": "f4", "double": "f8", "uchar": "u1", "ushort": "u2"}
    body = b""
    for point in points:
        body += np.array(point, order + kinds[number]).tobytes() + b"\7"
    for face in faces:
        body += np.array(len(face), order + kinds[size]).tobytes()
        body += np.array(face, order + "i4").tobytes() + b"\1"
    return "\n".join(head).encode() + body + b"\0\0\0\3"


LAYOUTS = ["ascii", "binary_little_endian", "binary_big_endian"]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("faces", [[range(8)], [range(8), (0, 1, 2)], [(0, 1, 5), (0, 5, 6, 7)]])
def test_faces_of_a_ply_may_have_any_number_of_corners(tmp_path, layout, faces):
    points = [(x, y, 0.5) for x, y in U]
    (tmp_path / "u.ply").write_bytes(ply(layout, points, faces, "double", "ushort"))
    found = read_triangles(tmp_path / "u.ply")
    area = 0.5 * np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])[:, 2]
    wanted = [polygon_area_vector(np.array(points)[list(face)])[2] for face in faces]
    assert area.sum() == pytest.approx(sum(wanted))
    assert len(found) == sum(len(face) - 2 for face in faces)


@pytest.mark.parametrize("layout", LAYOUTS)
def test_broken_ply_files_are_refused(tmp_path, layout):
    points = [(x, y, 0.5) for x, y in U]
    whole = ply(layout, points, [range(8), (0, 1, 2)])
    broken = [whole[:20], whole[:-30], whole.replace(b"vertex 8", b"vertex 9999999"), b"ply\n"]
    broken += [
        whole.replace(b"property float y", b"property float w"),
        b"",
        whole[: len(whole) // 2],
    ]
    broken += [whole.replace(b"vertex_indices", b"neighbours"), ply(layout, points, [(0, 1, 88)])]
    for content in broken:
        (tmp_path / "u.ply").write_bytes(content)
        with pytest.raises(InputError, match="not a readable ply mesh"):
            read_triangles(tmp_path / "u.ply")


def test_an_off_file_may_have_comments_colours_and_concave_faces(tmp_path):
    lines = ["COFF # a U", "# made by hand", "8 2 0"]
    lines += [f"{x} {y} 0.5 255 0 0 255" for x, y in U]
    lines += ["8 0 1 2 3 4 5 6 7 0.5 0.5 0.5", "2 0 1", "trailing words"]
    (tmp_path / "u.off").write_text("\n".join(lines))
    heights = import_terrain(tmp_path / "u.off", resolution=0.05)
    assert np.isfinite(heights.heights).sum() * 0.05**2 == pytest.approx(10.0, rel=0.01)
    for content in (
        "",
        "OFF",
        "OFF\n3 1 0\n0 0 0\n",
        "OFF BINARY\n1 1 1",
        "OFF\n1 1 0\n0 0 0\n3 0 0 7",
    ):
        (tmp_path / "u.off").write_text(content)
        with pytest.raises(InputError, match="not a readable off mesh"):
            import_terrain(tmp_path / "u.off")


@pytest.mark.parametrize("kind", ["obj", "stl_ascii", "ply"])
def test_a_byte_order_mark_is_passed_over(tmp_path, steps, kind):
    path = tmp_path / f"steps.{kind[:3]}"
    content = steps.export(file_type=kind, **({"encoding": "ascii"} if kind == "ply" else {}))
    path.write_bytes(b"\xef\xbb\xbf" + (content.encode() if isinstance(content, str) else content))
    assert len(read_triangles(path)) == len(steps.faces)


@pytest.mark.parametrize("end", ["\n", "\r\n", "  \n"])
def test_a_backslash_continues_a_line(tmp_path, end):
    lines = [f"v {x} \\{end} {y} 0" for x, y in U] + [f"f 1 2 3 4 \\{end}5 6 \\{end} 7 8"]
    (tmp_path / "u.obj").write_bytes("\n".join(lines).encode())
    (one,) = [
        sum(polygon_area_vector(v)[2] for v in load_scene(tmp_path / "u.obj").surfaces.values())
    ]
    assert one == pytest.approx(10.0)


@pytest.mark.parametrize("tail", [b"x", b"made by CAD 3000", bytes(100), b"solid"])
def test_bytes_after_the_triangles_are_left_out_and_said(tmp_path, steps, caplog, tail):
    (tmp_path / "steps.stl").write_bytes(steps.export(file_type="stl") + tail)
    assert len(read_triangles(tmp_path / "steps.stl")) == len(steps.faces)
    assert f"{len(tail)} bytes after its 36 triangles are left out" in caplog.text


def test_an_understated_number_of_triangles_is_refused(tmp_path, steps):
    content = bytearray(steps.export(file_type="stl"))
    content[80:84] = (30).to_bytes(4, "little")
    (tmp_path / "steps.stl").write_bytes(content)
    with pytest.raises(InputError, match="its length is not that of the triangles it claims"):
        read_triangles(tmp_path / "steps.stl")


def long_obj(rng, form):
    """Return an OBJ text of 300 points and 300 faces of 3 to 5 corners, and the same in short."""
    angle = np.arange(5) * 2.0 * np.pi / 5
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([ring + rng.uniform(-9, 9, 3) for _ in range(60)]).round(4)
    faces = [
        [5 * int(k) + each for each in range(rng.integers(3, 6))] for k in rng.integers(0, 60, 300)
    ]
    lines = [f"v {x} {y} {z}" + " 0.5 0.5 0.5" * (form == "colours") for x, y, z in points]
    write = {"slashes": "{0}/{0}/{0}", "negative": "{1}"}.get(form, "{0}")
    lines += ["f " + " ".join(write.format(k + 1, k - 300) for k in face) for face in faces]
    mixed = [line for pair in zip(lines[:300], ["# between"] * 300, strict=True) for line in pair]
    return lines, [*mixed, *(line + "\n#" for line in lines[300:])]


@pytest.mark.parametrize("form", ["plain", "slashes", "negative", "colours"])
def test_long_runs_of_lines_are_read_as_single_lines_are(tmp_path, form):
    for text, path in zip(
        long_obj(np.random.default_rng(2), form), ("a.obj", "b.obj"), strict=True
    ):
        (tmp_path / path).write_text("\r\n".join(text) if path == "a.obj" else "\n".join(text))
    fast, slow = (read_triangles(tmp_path / path) for path in ("a.obj", "b.obj"))
    assert len(fast) > 300
    np.testing.assert_array_equal(fast, slow)


@pytest.mark.parametrize(
    "flaw", ["1 2", "1 2 301", "1 2 0", "1 2 x", "1 2 2.5", "1 2 1e30", "1 nan 3"]
)
def test_a_flaw_in_a_long_run_is_named(tmp_path, flaw):
    lines, _ = long_obj(np.random.default_rng(2), "plain")
    lines[450] = f"f {flaw}"
    (tmp_path / "a.obj").write_text("\n".join(lines))
    with pytest.raises(InputError, match=f"{flaw}|2 corners"):
        read_triangles(tmp_path / "a.obj")
