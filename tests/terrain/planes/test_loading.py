"""Maps where scenes are needed: found surfaces as a scene, said in one line, and as a command."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.terrain import (
    PlaneSearch,
    Reading,
    has_polygons,
    is_map,
    load_scene,
    read_scene,
    write_height_map,
)
from jaxleas.types import InputError
from tests.terrain.planes.conftest import noisy, stairs


@pytest.fixture
def stairs_file(tmp_path):
    path = tmp_path / "stairs.npz"
    write_height_map(path, noisy(stairs()[0]))
    return path


def test_a_map_is_loaded_as_the_scene_of_its_surfaces(stairs_file, caplog):
    scene = load_scene(stairs_file)
    assert len(scene.walkable) == 7
    assert "7 surfaces" in caplog.text
    assert "found in the map" in caplog.text
    cropped = load_scene(stairs_file, Reading(crop=(0.0, 0.9, 0.0, 1.2), origin="0,0,-1"))
    assert len(cropped.surfaces) == 3
    assert min(each[:, 2].min() for each in cropped.surfaces.values()) == pytest.approx(1, abs=0.01)
    assert is_map(stairs_file)
    assert not has_polygons(stairs_file)


def test_the_command_writes_a_scene_that_can_be_read(stairs_file, tmp_path, capsys):
    out, picture = tmp_path / "scene.json", tmp_path / "surfaces.png"
    cli.run(f"terrain surfaces {stairs_file} --out {out} --picture {picture}".split())
    assert "7 surfaces" in capsys.readouterr().out
    assert picture.stat().st_size > 1000
    written = read_scene(out)
    cli.run(f"terrain import {stairs_file} --out {tmp_path / 'again.json'}".split())
    again = read_scene(tmp_path / "again.json")
    for name, polygon in load_scene(stairs_file).surfaces.items():
        np.testing.assert_allclose(written.surfaces[name], polygon, atol=1e-6)
        np.testing.assert_array_equal(written.surfaces[name], again.surfaces[name])


def test_where_no_surface_is_found_a_sentence_says_why(stairs_file, tmp_path):
    with pytest.raises(InputError, match=r"no surface was found .* too rough; --roughness"):
        load_scene(stairs_file, search=PlaneSearch(roughness=0.001))
    picture = tmp_path / "why.png"
    with pytest.raises(InputError, match="no surface was found"):
        cli.run(f"terrain surfaces {stairs_file} --roughness 0.001 --picture {picture}".split())
    assert picture.exists()


def test_values_of_the_search_do_not_apply_to_a_scene(stairs_file, tmp_path):
    out = tmp_path / "scene.json"
    cli.run(f"terrain surfaces {stairs_file} --out {out}".split())
    with pytest.raises(InputError, match=r"--inset does not apply to .*scene\.json"):
        load_scene(out, search=PlaneSearch(inset=0.1))
    with pytest.raises(InputError, match="is no map of heights"):
        cli.run(f"terrain surfaces {out}".split())
