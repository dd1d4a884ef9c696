import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from jaxleas.terrain import GeneratorConfig, HeightMap, draw_height_map, generate_arena, rasterise
from jaxleas.terrain.draw import VOID_COLOUR
from jaxleas.types import InputError


def pixels(ax):
    return np.asarray(ax.images[0].get_array())


def test_higher_is_brighter_and_void_is_neither():
    heights = np.repeat(np.linspace(0.0, 1.0, 20, dtype=np.float32)[:, None], 20, axis=1)
    heights[:, 15:] = np.nan
    drawn = pixels(draw_height_map(HeightMap(heights, 0.04, (0.0, 0.0))))
    column = drawn[:, 5]
    np.testing.assert_allclose(column[:, 0], column[:, 2])  # grey
    assert (np.diff(column[:, 0]) >= 0.0).all()
    assert column[-1, 0] - column[0, 0] > 0.5
    np.testing.assert_allclose(drawn[:, 17], np.broadcast_to(to_rgb(VOID_COLOUR), (20, 3)))


def test_a_few_tall_boxes_do_not_darken_the_ground():
    heights = np.zeros((50, 50), dtype=np.float32)
    heights[:25] = 0.5
    plain = pixels(draw_height_map(HeightMap(heights.copy(), 0.04, (0.0, 0.0))))
    heights[40:43, 40:43] = 2.0
    boxed = pixels(draw_height_map(HeightMap(heights, 0.04, (0.0, 0.0))))
    np.testing.assert_allclose(boxed[10, 10], plain[10, 10])


def test_axes_are_in_metres_and_given_axes_are_used():
    height_map = HeightMap(np.zeros((10, 20), dtype=np.float32), 0.1, (5.05, -2.95))
    ax = Figure().subplots()
    assert draw_height_map(height_map, ax=ax, title="here") is ax
    assert ax.images[0].get_extent() == pytest.approx([5.0, 7.0, -3.0, -2.0])
    assert ax.get_title() == "here"


def test_the_picture_is_written(tmp_path):
    height_map = rasterise(generate_arena(GeneratorConfig(rows=2, columns=2), 0).scene)
    draw_height_map(height_map, tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match=r"\.png, \.svg or \.pdf"):
        draw_height_map(height_map, tmp_path / "map.xyz")


def test_a_large_map_is_thinned():
    height_map = HeightMap(np.zeros((3, 5000), dtype=np.float32), 0.01, (0.0, 0.0))
    assert max(pixels(draw_height_map(height_map)).shape[:2]) <= 1600
