import numpy as np
import pytest

from jaxleas.terrain import HeightMap, read_height_map, write_height_map
from jaxleas.terrain.importers import import_terrain
from jaxleas.types import InputError


@pytest.fixture
def height_map():
    heights = np.random.default_rng(0).normal(size=(7, 11)).astype(np.float32)
    heights[2, 3] = np.nan
    return HeightMap(heights, 0.05, (-1.0, 2.0))


def test_a_map_survives_its_file(tmp_path, height_map):
    write_height_map(tmp_path / "map.npz", height_map)
    read = read_height_map(tmp_path / "map.npz")
    np.testing.assert_array_equal(read.heights, height_map.heights)
    assert read.heights.dtype == np.float32
    assert (read.resolution, read.origin) == (height_map.resolution, height_map.origin)


def test_cell_centres_have_the_cells_heights(height_map):
    rows, columns = np.indices(height_map.shape)
    x = height_map.origin[0] + columns.ravel() * height_map.resolution
    y = height_map.origin[1] + rows.ravel() * height_map.resolution
    heights = height_map.height_at(np.column_stack([x, y]))
    np.testing.assert_array_equal(heights, height_map.heights.ravel())


def test_sampling_moves_with_the_map(height_map):
    shift = np.array([0.37, -5.2])
    moved = HeightMap(
        height_map.heights, 0.05, (height_map.origin[0] + shift[0], height_map.origin[1] + shift[1])
    )
    points = np.random.default_rng(1).uniform((-1.2, 1.8), (-0.3, 2.5), size=(500, 2))
    np.testing.assert_array_equal(height_map.height_at(points), moved.height_at(points + shift))


def test_beyond_the_extent_there_is_no_ground(height_map):
    x_min, x_max, y_min, y_max = height_map.extent
    middle = (0.5 * (x_min + x_max), 0.5 * (y_min + y_max))
    beyond = [
        (x_min - 1e-6, middle[1]),
        (x_max + 1e-6, middle[1]),
        (middle[0], y_min - 1e-6),
        (middle[0], y_max + 1e-6),
        (1e300, 0.0),
        (np.nan, middle[1]),
    ]
    assert np.isnan(height_map.height_at(np.array(beyond))).all()
    corner = height_map.height_at(np.array([(x_min + 1e-6, y_max - 1e-6)]))
    assert corner[0] == height_map.heights[-1, 0]


def flat(value=0.0, shape=(4, 5), dtype=np.float32):
    return np.full(shape, value, dtype=dtype)


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"heights": flat(dtype="U3")}, "heights are <U3; they must be numbers"),
        ({"heights": flat(dtype=bool)}, "heights are bool"),
        ({"heights": flat(shape=(4,))}, r"shape \(4,\)"),
        ({"heights": flat(shape=(4, 5, 1))}, r"shape \(4, 5, 1\)"),
        ({"heights": flat(shape=(0, 5))}, r"shape \(0, 5\)"),
        ({"heights": flat(np.nan)}, "every height is NaN"),
        ({"heights": flat(np.inf)}, "infinity"),
        ({"heights": flat(25_000.0)}, "are these metres"),
        ({"resolution": 0.0}, "resolution 0 m is outside"),
        ({"resolution": -0.04}, "outside"),
        ({"resolution": 40.0}, "outside"),
        ({"resolution": np.nan}, "outside"),
        ({"resolution": [0.04, 0.04]}, "one number"),
        ({"resolution": "fine"}, "one number"),
        ({"origin": [0.0, 0.0, 0.0]}, "two finite numbers"),
        ({"origin": [0.0, np.nan]}, "two finite numbers"),
        ({"origin": ["a", "b"]}, "two finite numbers"),
    ],
)
def test_unusable_maps_are_refused(tmp_path, changed, problem):
    path = tmp_path / "map.npz"
    np.savez(path, **({"heights": flat(), "resolution": 0.04, "origin": [0.0, 0.0]} | changed))
    with pytest.raises(InputError, match=problem) as caught:
        read_height_map(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("dtype", ["f2", "f8", ">f4", "i1", "u2", "i8"])
def test_heights_of_any_number_type_are_read(tmp_path, dtype):
    heights = np.array([[0, 1, 2], [3, 4, 100]], dtype)
    np.savez(tmp_path / "map.npz", heights=heights, resolution=1, origin=[0, 0])
    with pytest.raises(InputError, match="resolution 1 m is outside"):
        read_height_map(tmp_path / "map.npz")
    np.savez(tmp_path / "map.npz", heights=heights, resolution=0.5, origin=[0, 0])
    found = read_height_map(tmp_path / "map.npz")
    assert found.heights.dtype == np.float32
    np.testing.assert_array_equal(found.heights, heights.astype(float))


def test_a_map_without_an_array_is_refused(tmp_path):
    np.savez(tmp_path / "map.npz", heights=flat(), origin=[0.0, 0.0])
    with pytest.raises(InputError, match="lacks the array resolution"):
        read_height_map(tmp_path / "map.npz")


def test_a_truncated_map_is_refused(tmp_path, height_map):
    path = tmp_path / "map.npz"
    write_height_map(path, height_map)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(InputError, match="not a readable"):
        read_height_map(path)


def test_objects_in_a_map_are_refused(tmp_path):
    path = tmp_path / "map.npz"
    np.savez(path, heights=np.array([[None, 1]]), resolution=0.04, origin=[0.0, 0.0])
    with pytest.raises(InputError, match="not a readable"):
        read_height_map(path)


def test_a_height_array_without_an_origin_is_read_and_said(tmp_path, caplog):
    np.savez(tmp_path / "map.npz", height=flat(), resolution=0.04)
    found = read_height_map(tmp_path / "map.npz")
    assert found.origin == (0.0, 0.0)
    np.testing.assert_array_equal(found.heights, flat())
    assert "states no origin" in caplog.text


def test_heights_in_millimetres_are_noticed(tmp_path, caplog):
    np.savez(tmp_path / "map.npz", heights=1000.0 * np.eye(20), resolution=0.04, origin=[0, 0])
    import_terrain(tmp_path / "map.npz")
    assert "span 1000 m on a map 0.8 m wide: are they metres?" in caplog.text
