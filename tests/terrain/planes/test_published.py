"""Maps made by others: their surfaces have the heights, areas and numbers that are known."""

from pathlib import Path

import numpy as np
import pytest

from jaxleas.terrain import Cell, PlaneSearch, find_surfaces, import_terrain, load_scene
from jaxleas.terrain.polygons import polygon_area_vector

SHARED = Path(__file__).resolve().parents[4] / "shared"
TERRAINS, CASES = SHARED / "data" / "terrains", SHARED / "cases"
EXACT = PlaneSearch(inset=0.0)


def needed(path: Path) -> Path:
    if not path.exists():
        pytest.skip(f"needs {path.name} of ../shared")
    return path


def areas_of(found) -> dict[float, float]:
    """Return the area of surfaces by their height, to a centimetre [m^2]."""
    areas: dict[float, float] = {}
    for polygon in found.polygons.values():
        height = round(float(polygon[:, 2].mean()), 2)
        areas[height] = areas.get(height, 0.0) + float(polygon_area_vector(polygon)[2])
    return areas


def levels_of(height_map) -> dict[float, float]:
    """Return the area of cells by their height, to a centimetre [m^2]."""
    heights = np.round(height_map.heights[np.isfinite(height_map.heights)].astype(float), 2)
    values, counts = np.unique(heights, return_counts=True)
    return dict(zip(values.tolist(), (counts * height_map.resolution**2).tolist(), strict=True))


@pytest.mark.parametrize(
    ("name", "cell", "top", "surfaces"),
    [
        ("cpd_straight_stairs_1m_1m_60cm.png", 0.02, 0.6, 4),
        ("cpd_holes.png", 0.02, 0.6, 4),
        ("ocs2_gaps.png", 0.04, 0.35, 11),
        ("ocs2_stepping_stones.png", 0.04, 0.35, 44),
    ],
)
def test_maps_of_level_parts(name, cell, top, surfaces):
    height_map = import_terrain(needed(TERRAINS / name), resolution=cell, z_min=0.0, z_max=top)
    found = find_surfaces(height_map, EXACT)
    assert len(found.fit) == surfaces
    assert found.root_mean_square < 2e-4
    assert found.shares[Cell.SURFACE] > 0.999
    wanted = levels_of(height_map)
    for height, area in areas_of(found).items():
        assert area == pytest.approx(wanted[height], rel=0.05), height
    total = sum(wanted.values())
    assert found.area == pytest.approx(total, rel=0.03)


def test_a_grid_map_of_a_bag():
    pytest.importorskip("rosbags", reason="needs the extra maps")
    height_map = import_terrain(needed(TERRAINS / "grid_map.bag"))
    found = find_surfaces(height_map, EXACT)
    wanted = levels_of(height_map)
    for height, area in areas_of(found).items():
        assert min(abs(height - each) for each in wanted) < 0.011
        assert area < 1.05 * sum(a for h, a in wanted.items() if abs(h - height) < 0.011)
    assert found.area > 0.7 * sum(wanted.values())


def test_the_terrain_of_the_plane_decomposition_has_ridges_ramps_and_rough_ground():
    height_map = import_terrain(
        needed(TERRAINS / "cpd_terrain.png"), resolution=0.02, z_min=0.0, z_max=0.6
    )
    found = find_surfaces(height_map)
    void = found.shares[Cell.VOID]  # a few lone cells are closed
    assert 0.95 * height_map.void_fraction < void <= height_map.void_fraction
    assert 0.05 < found.shares[Cell.ROUGH] < 0.2  # the two fields of Perlin noise
    for name, polygon in found.polygons.items():
        middle = polygon.mean(axis=0)
        off = height_map.height_at(middle[None, :2])[0] - middle[2]
        assert np.isnan(off) or abs(off) < 0.03, name


@pytest.mark.parametrize("name", ["ledge_up_40cm", "gap_20cm"])
def test_small_maps_have_two_floors(name):
    path = needed(CASES / f"{name}.npz")
    height_map = import_terrain(path)
    scene = load_scene(path)
    assert len(scene.surfaces) == 2
    wanted = levels_of(height_map)
    assert {round(float(each[:, 2].mean()), 2) for each in scene.surfaces.values()} == set(wanted)


def test_eight_bit_stairs_and_a_spike():
    grey = needed(CASES / "stairs_8bit_grey.png")
    height_map = import_terrain(grey, resolution=0.04, z_min=0.0, z_max=0.6)
    found = find_surfaces(height_map, EXACT)
    assert found.area == pytest.approx(sum(levels_of(height_map).values()), rel=0.05)
    spike = find_surfaces(import_terrain(needed(CASES / "spike_under_start.npz")))
    assert max(each[:, 2].max() for each in spike.polygons.values()) < 0.7
