"""ESRI ASCII grids, as the various programs write them."""

import numpy as np
import pytest

from jaxleas.terrain import import_terrain, load_scene
from jaxleas.types import InputError

ROWS = "4 5 6\n1 -9999 3\n"  # from the north
HEAD = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 0.25\n"


def grid(tmp_path, text, name="dem.asc"):
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return tmp_path / name


def test_rows_from_the_north_in_the_stated_place(tmp_path, caplog):
    found = import_terrain(grid(tmp_path, HEAD + "NODATA_value -9999\n" + ROWS))
    assert found.resolution == 0.25
    assert found.origin == (10.125, 20.125)
    np.testing.assert_array_equal(found.heights, [[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])
    assert not caplog.text


@pytest.mark.parametrize(
    "text",
    [
        b"\xef\xbb\xbf" + (HEAD + ROWS).encode(),
        (HEAD + ROWS).replace("\n", "\r\n"),
        HEAD.upper().replace(" ", "   ") + ROWS.replace("\n", " "),
        HEAD.replace("corner 10", "center 10.125").replace("corner 20", "center 20.125") + ROWS,
        HEAD.replace("cellsize 0.25", "dx 0.25\ndy 0.25") + ROWS,
        (HEAD + "nodata_value -1\n" + ROWS).replace("-9999", "-1"),
        (HEAD + "NODATA_value nan\n" + ROWS).replace("-9999", "nan"),
        (HEAD + ROWS).replace("0.25", "0,25").replace("4", "4,0"),
    ],
)
def test_other_spellings_of_the_same_grid(tmp_path, text):
    found = import_terrain(grid(tmp_path, text))
    assert found.origin == pytest.approx((10.125, 20.125))
    np.testing.assert_array_equal(found.heights, [[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]])


def test_a_survey_in_utm_is_moved_and_coarse_cells_are_resampled(tmp_path, caplog):
    far = HEAD.replace("10", "450000").replace("20", "5400000").replace("0.25", "1")
    found = import_terrain(grid(tmp_path, far + ROWS), scale=0.3048)
    assert found.resolution == 0.5
    assert found.heights[0, 0] == pytest.approx(0.3048)
    assert "450000,5400000 m becomes x = y = 0" in caplog.text
    assert "cells of 1 m are resampled" in caplog.text


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "does not begin with ncols and nrows"),
        (ROWS, "does not begin with ncols and nrows"),
        (HEAD + "1 2 3\n", "has 3 heights, where 2 rows of 3 need 6"),
        (HEAD + ROWS + "7", "has 7 heights"),
        (HEAD + ROWS.replace("5", "x"), "something that is no number"),
        (HEAD.replace("ncols 3", "ncols x") + ROWS, "ncols is 'x', no number"),
        (HEAD.replace("ncols 3", "ncols -3") + ROWS, "ncols is -3; a map is at least 2 x 2"),
        (HEAD.replace("ncols 3", "ncols 2.5") + ROWS, "ncols is 2.5"),
        (HEAD.replace("ncols 3", "ncols 1e7").replace("nrows 2", "nrows 1e7"), "more than"),
        (HEAD.replace("cellsize 0.25\n", "") + ROWS, "states no cellsize"),
        (HEAD.replace("0.25", "-1") + ROWS, "states no cellsize"),
        (HEAD.replace("cellsize 0.25", "dx 0.2\ndy 0.3") + ROWS, "cells of 0.2 x 0.3"),
        (HEAD.replace("0.25", "0.000277") + ROWS, "must be degrees; warp it to metres"),
        (HEAD.replace("corner 10", "corner nan") + ROWS, "xllcorner is no finite number"),
        (HEAD + "-9999 " * 6, "every height is NaN"),
        (HEAD + ROWS.replace("5", "inf"), "heights hold infinity"),
    ],
)
def test_what_is_no_grid_is_refused_by_one_sentence(tmp_path, text, reason):
    with pytest.raises(InputError, match=reason) as caught:
        import_terrain(grid(tmp_path, text))
    assert "dem.asc" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("a.stl.gz", "packed file that is not read: unpack it first"),
        ("a.usd", r"USD stage that is not read: export it as \.glb"),
        ("a.USDZ", r"export it as \.glb"),
        ("a.dae", r"export it as \.glb"),
        ("a.jpg", r"save it as \.png"),
        ("a.world", "give the mesh"),
        ("a.las", "GeoTIFF"),
        ("a.foo", "unknown terrain file type '.foo'; known are"),
    ],
)
def test_what_is_not_read_says_what_would_do(tmp_path, name, remedy):
    path = grid(tmp_path, "x", name)
    with pytest.raises(InputError, match=remedy):
        import_terrain(path)
    with pytest.raises(InputError, match=remedy if name != "a.foo" else "JSON"):
        load_scene(path)
