"""Real meshes from file to plan: what was imported is walked on by all planners."""

import json

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import read_plan
from jaxleas.files import write_npz
from jaxleas.terrain import load_scene, mesh_to_scene, read_scene
from jaxleas.types import InputError
from tests.contacts.test_from_guide import straight

FLOOR = straight(2.4, yaw=np.pi / 2, start=(3.9, -1.0, 0.9))
CINDER_BLOCKS = straight(7.0, start=(-3.5, 0.0, 0.95))


@pytest.mark.parametrize(
    ("mesh", "guide", "planner"),
    [
        ("bauzil_stairs", FLOOR, "mip"),
        ("bauzil_stairs", FLOOR, "sl1m"),
        ("bauzil_stairs", FLOOR, "sampling"),
        ("darpa", CINDER_BLOCKS, "mip"),
        ("darpa", CINDER_BLOCKS, "sl1m"),
    ],
)
def test_from_mesh_to_checked_plan(shared, tmp_path, monkeypatch, mesh, guide, planner) -> None:
    monkeypatch.chdir(tmp_path)
    scene = shared / "data" / "meshes" / f"{mesh}.stl"
    names = ("time", "position", "yaw", "velocity", "valid")
    write_npz("guide.npz", **{name: getattr(guide, name) for name in names})
    more = [] if planner == "sampling" else ["--problem", "made.json"]
    line = f"contacts guide.npz --scene {scene} --planner {planner} --out plan.json"
    cli.run([*line.split(), *more])
    plan = read_plan("plan.json")
    assert plan.feasible, plan.reason
    asked = f"--guide guide.npz --scene {scene}" if planner == "sampling" else "made.json"
    cli.run(f"check plan.json {asked}".split())


def test_a_mesh_becomes_a_scene_file(shared, tmp_path) -> None:
    mesh = shared / "data" / "meshes" / "flat_hole.stl"
    cli.run(f"terrain import {mesh} --out {tmp_path}/scene.json --scale 2".split())
    written, twice = read_scene(tmp_path / "scene.json"), mesh_to_scene(mesh, scale=2.0)
    assert list(written.surfaces) == list(twice.surfaces)
    for name, vertices in twice.surfaces.items():
        np.testing.assert_allclose(written.surfaces[name], vertices, atol=1e-6)
    assert list(load_scene(mesh).surfaces) == list(twice.surfaces)


def test_a_scene_without_surfaces_is_refused(tmp_path) -> None:
    (tmp_path / "scene.json").write_text(json.dumps({"surfaces": {}}))
    with pytest.raises(InputError, match="has no surfaces"):
        load_scene(tmp_path / "scene.json")
