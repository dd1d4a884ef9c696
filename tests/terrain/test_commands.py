import numpy as np
import pytest

from jaxleas.terrain import HeightMap, read_height_map, read_scene, write_height_map
from jaxleas.terrain.commands import convert, generate, scenario, show
from jaxleas.terrain.reading import Reading
from jaxleas.types import InputError


def test_generate_then_import_then_show(tmp_path, capsys):
    scene = generate(out=tmp_path / "scene.json", seed=4, rows=2, columns=3)
    assert len(read_scene(scene).surfaces) > 5
    converted = convert(scene, out=tmp_path / "map.npz", reading=Reading(resolution=0.05))
    assert read_height_map(converted).resolution == 0.05
    picture = show(converted, out=tmp_path / "map.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    printed = capsys.readouterr().out
    assert "2 x 3 tiles" in printed
    assert "cells of 0.05 m" in printed


def test_the_same_seed_writes_the_same_file(tmp_path):
    first = generate(out=tmp_path / "a.json", seed=7).read_bytes()
    assert generate(out=tmp_path / "b.json", seed=7).read_bytes() == first
    assert generate(out=tmp_path / "c.json", seed=8).read_bytes() != first


def test_show_never_writes_over_what_it_reads(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_height_map("map.npz", HeightMap(np.zeros((9, 9), np.float32), 0.04, (0.0, 0.0)))
    assert str(show(tmp_path / "map.npz")) == "map_view.png"
    assert (tmp_path / "map_view.png").is_file()


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        ({"rows": 0}, "rows = 0"),
        ({"columns": 10**6}, "columns = 1000000"),
        ({"seed": -1}, "seed -1"),
        ({"out": "scene.txt"}, r"must end in \.json"),
    ],
)
def test_generate_refuses_what_makes_no_arena(tmp_path, arguments, problem):
    arguments = {"out": "scene.json"} | arguments
    with pytest.raises(InputError, match=problem):
        generate(**(arguments | {"out": tmp_path / arguments["out"]}))


def test_show_refuses_to_draw_over_what_it_reads(tmp_path):
    path = tmp_path / "map.png"
    path.write_bytes(b"")
    with pytest.raises(InputError, match=r"--out .*map\.png is the terrain itself"):
        show(path, out=tmp_path / "." / "map.png")
    assert path.read_bytes() == b""


def test_a_named_scenario_is_written_with_its_areas(tmp_path, capsys):
    written = scenario("hole", out=tmp_path / "hole.json", seed=2)
    assert set(read_scene(written).areas) == {"start", "goal"}
    assert "4 surfaces" in capsys.readouterr().out
    with pytest.raises(InputError, match="there are rubble"):
        scenario("qqq", out=tmp_path / "moon.json")
    with pytest.raises(InputError, match="must not be negative"):
        scenario("hole", out=tmp_path / "moon.json", seed=-1)
    assert not (tmp_path / "moon.json").exists()
