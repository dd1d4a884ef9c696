"""Tables of heights: .npy and text."""

import numpy as np
import pytest

from jaxleas.terrain import import_terrain
from jaxleas.types import InputError

HEIGHTS = np.array([[0.0, 0.5, 1.0], [0.25, np.nan, 2.0]])


def text(mark=",", decimal=".", nothing="nan", end=""):
    rows = [
        mark.join(nothing if np.isnan(v) else f"{v}".replace(".", decimal) for v in row) + end
        for row in HEIGHTS
    ]
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    "content",
    [
        text(), text("\t"), text("  "), text(";"), text(";", ","), text(",", nothing=""),
        text(",", nothing="NaN", end=","), "\ufeff" + text(), "# heights in metres\n" + text(),
        text(", "),
    ],
)  # fmt: skip
def test_a_grid_of_text_is_a_map_whose_first_row_is_the_lowest_y(tmp_path, content):
    (tmp_path / "map.csv").write_text(content, encoding="utf-8")
    found = import_terrain(tmp_path / "map.csv", resolution=0.1)
    np.testing.assert_array_equal(found.heights, HEIGHTS.astype(np.float32))
    assert found.extent == pytest.approx((0.0, 0.3, 0.0, 0.2))


@pytest.mark.parametrize("dtype", ["f8", ">f4", "i2", "u1"])
def test_an_array_of_any_number_type_is_a_map(tmp_path, dtype):
    heights = np.arange(6, dtype=dtype).reshape(2, 3)
    np.save(tmp_path / "map.npy", heights)
    found = import_terrain(tmp_path / "map.npy", resolution=0.1, scale=0.005)
    np.testing.assert_allclose(found.heights, 0.005 * np.arange(6).reshape(2, 3))
    with (tmp_path / "map.npy").open("ab") as stream:
        stream.write(b"trailing")
    np.testing.assert_array_equal(
        import_terrain(tmp_path / "map.npy", resolution=0.1, scale=0.005).heights, found.heights
    )


def test_numbers_for_no_data_are_no_ground(tmp_path, caplog):
    np.save(tmp_path / "map.npy", np.array([[-9999, 1], [2, 3]], np.int16))
    found = import_terrain(tmp_path / "map.npy", resolution=0.1)
    assert np.isnan(found.heights[0, 0])
    assert "1 cells of -9999 mean no data" in caplog.text


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
def test_points_on_a_grid_are_a_map(tmp_path, mark):
    rows = [
        f"{0.2 * x + 1.0:.3f}{mark}{0.2 * y:.3f}{mark}{x + 0.1 * y:.3f}"
        for x in range(5)
        for y in range(4)
    ]
    rows.pop(7)
    (tmp_path / "points.csv").write_text("\n".join([mark.join("xyz"), *rows[::-1]]))
    found = import_terrain(tmp_path / "points.csv")
    assert found.resolution == pytest.approx(0.2)
    assert found.origin == pytest.approx((1.0, 0.0))
    wanted = np.arange(5.0) + 0.1 * np.arange(4.0)[:, None]
    wanted[3, 1] = np.nan
    np.testing.assert_allclose(found.heights, wanted, atol=1e-6)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("", "no rows"), ("1,2\n3\n", "rows of 1 to 2 columns"), ("1,2\n3,four\n", "no number"),
        ("1,2\n3,inf\n", "infinity"), ("1,2,3\n" * 30, "if they are points, put the line x,y,z"),
        ("x,z\n1,2\n", "points need x, y and z"),
        ("x,y,z\n0,0,0\n0.1,0.033,0\n0.25,0.1,0\n", "no grid"),
        ("x,y,z\n1,2\n", "rows of 2 to 3 columns"), ("x,y,z\n", "header and no rows"),
        ("nan,nan\nnan,nan\n", "no ground"),
        ("1\n2\n", "at least 2 x 2"),
    ],
)  # fmt: skip
def test_what_is_no_table_is_refused(tmp_path, content, problem):
    (tmp_path / "map.csv").write_text(content)
    with pytest.raises(InputError, match=problem):
        import_terrain(tmp_path / "map.csv", **({} if "x" in content else {"resolution": 0.1}))


def test_a_table_needs_its_resolution(tmp_path):
    np.save(tmp_path / "map.npy", np.zeros((4, 4)))
    with pytest.raises(InputError, match="say its resolution"):
        import_terrain(tmp_path / "map.npy")
    np.save(tmp_path / "map.npy", np.zeros((4, 4), complex))
    with pytest.raises(InputError, match="numbers, truth values and text"):
        import_terrain(tmp_path / "map.npy", resolution=0.1)


def test_a_channel_of_one_and_sixteen_bit_text_are_read(tmp_path):
    heights = np.arange(12.0).reshape(3, 4)
    for name, array in (("last", heights[..., None]), ("first", heights[None])):
        np.save(tmp_path / f"{name}.npy", array)
        found = import_terrain(tmp_path / f"{name}.npy", resolution=0.1).heights
        np.testing.assert_array_equal(found, heights)
    text = "\n".join(",".join(map(str, row)) for row in heights.tolist())
    (tmp_path / "wide.csv").write_bytes(text.encode("utf-16"))
    found = import_terrain(tmp_path / "wide.csv", resolution=0.1).heights
    np.testing.assert_array_equal(found, heights)
