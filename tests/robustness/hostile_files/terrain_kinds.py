"""Terrains: maps, scenes, meshes, pictures."""

from functools import partial
from pathlib import Path

import numpy as np
from PIL import Image

from jaxleas.terrain import Scene, write_height_map, write_scene
from jaxleas.terrain.rasterise import rasterise
from tests.robustness.hostile_files import binary_mutations as b
from tests.robustness.hostile_files import mutations as m
from tests.robustness.hostile_files.imported_kinds import imported_kinds
from tests.robustness.hostile_files.kinds import Kind, kind_of
from tests.robustness.hostile_files.variant_kinds import variant_kinds


def floor() -> Scene:
    """Return two surfaces, an obstacle and an area."""
    square = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
    step = [[2, 0, 0.1], [3, 0, 0.1], [3, 1, 0.1], [2, 1, 0.1]]
    top = [[0.5, 0.2, 0.8], [0.8, 0.2, 0.8], [0.8, 0.5, 0.8], [0.5, 0.5, 0.8]]
    area = [[0, 0], [1, 0], [1, 1], [0, 1]]
    as_arrays = lambda group: {name: np.array(each, float) for name, each in group.items()}  # noqa: E731
    return Scene(
        as_arrays({"floor": square, "step": step}),
        as_arrays({"box_top": top}),
        as_arrays({"a": area}),
    )


def terrain_kinds(folder: Path) -> list[Kind]:
    from jaxleas.terrain import import_png, import_terrain
    from jaxleas.terrain.meshes.to_scene import mesh_to_scene

    scene = floor()
    write_scene(folder / "scene.json", scene)
    write_height_map(folder / "heights.npz", rasterise(scene, 0.1))
    values = np.random.default_rng(0).integers(1, 65536, size=(9, 12)).astype(np.uint16)
    Image.fromarray(values).save(folder / "grey.png")
    corners = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0.2], [0, 1, 0.2], [1, 2, 0.1]], np.float32)
    faces = [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    triangles = np.zeros(len(faces), record)
    triangles["corners"] = corners[faces]
    head = b"made by nobody".ljust(80) + np.uint32(len(faces)).tobytes()
    (folder / "binary.stl").write_bytes(head + triangles.tobytes())
    text = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners[face])
        + "endloop\nendfacet\n"
        for face in faces
    )
    (folder / "text.stl").write_text(f"solid x\n{text}endsolid x\n")
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f 1 2 3 4", "f 4/1/1 3//2 5"]
    (folder / "mesh.obj").write_text("# a mesh\nmtllib x.mtl\nvt 0 0\n" + "\n".join(lines) + "\n")
    concave = [(0, 0), (4, 0), (4, 4), (3, 4), (3, 1), (1, 1), (1, 4), (0, 4)]
    outline = "\n".join([*(f"v {x} {y} 0" for x, y in concave), "f 1 2 3 4 \\", " 5 6 7 8\n"])
    (folder / "concave.obj").write_text(outline)

    def mesh(path: Path) -> None:
        import_terrain(path, resolution=0.5)
        mesh_to_scene(path)

    return [
        kind_of("height map", folder / "heights.npz", import_terrain, b.mutate_npz),
        kind_of(
            "scene", folder / "scene.json", partial(import_terrain, resolution=0.5), m.mutate_json
        ),
        kind_of("binary STL", folder / "binary.stl", mesh, b.mutate_stl),
        kind_of("text STL", folder / "text.stl", mesh, m.mutate_text),
        kind_of("OBJ", folder / "mesh.obj", mesh, m.mutate_text),
        kind_of(
            "PNG",
            folder / "grey.png",
            partial(import_png, resolution=0.1, z_min=0.0, z_max=1.0),
            b.mutate_png,
        ),
        kind_of("concave OBJ", folder / "concave.obj", mesh, m.mutate_text),
        *imported_kinds(folder),
        *variant_kinds(folder),
    ]
