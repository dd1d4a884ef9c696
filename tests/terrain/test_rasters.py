"""GeoTIFF images, and GridMaps in bags of ROS 1 and 2."""

import struct
from pathlib import Path

import numpy as np
import pytest

from jaxleas.terrain import import_terrain
from jaxleas.types import InputError

tifffile = pytest.importorskip("tifffile", reason="needs the extra maps")
rosbags = pytest.importorskip("rosbags", reason="needs the extra maps")
from rosbags.rosbag1 import Writer as Writer1  # noqa: E402
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin  # noqa: E402
from rosbags.rosbag2 import Writer as Writer2  # noqa: E402
from rosbags.rosbag2.storage_mcap import zstd  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402

METRES = (34735, "H", 12, (1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 32632))
DEGREES = (34735, "H", 8, (1, 1, 0, 1, 1024, 0, 1, 2))


def slope(rows=40, columns=50):
    """Heights that grow to the east by 1 and to the north by 10 a cell, north row first."""
    return (
        np.arange(columns, dtype=np.float32) + 10.0 * np.arange(rows, dtype=np.float32)[::-1, None]
    )


def geotiff(path, heights, cell=0.25, corner=(100.0, 200.0), keys=METRES, more=(), **options):
    north = corner[1] + cell * heights.shape[0]
    tags = [(33550, "d", 3, (cell, cell, 0.0)), (33922, "d", 6, (0, 0, 0, corner[0], north, 0))]
    tifffile.imwrite(path, heights, extratags=[*tags, keys, *more], **options)
    return path


@pytest.mark.parametrize("compression", [None, "deflate", "lzw"])
@pytest.mark.parametrize("dtype", ["f4", "f8", "i2", "u2"])
def test_a_geotiff_has_its_heights_in_its_place(tmp_path, compression, dtype):
    path = geotiff(
        tmp_path / "dem.tif", slope().astype(dtype), compression=compression,
        predictor=compression is not None, tile=(16, 16),
    )  # fmt: skip
    found = import_terrain(path)
    assert found.resolution == 0.25
    assert found.extent == pytest.approx((100.0, 112.5, 200.0, 210.0))
    np.testing.assert_array_equal(found.heights, slope()[::-1])


def test_no_data_far_places_and_coarse_cells(tmp_path, caplog):
    heights = slope()
    heights[3, 4] = -500.0
    no_data = (42113, "s", 0, "-500")
    far = geotiff(tmp_path / "far.tif", heights, 2.0, (450_000.0, 5_400_000.0), more=[no_data])
    found = import_terrain(far)
    assert found.resolution == 0.5
    assert found.extent == pytest.approx((0.75, 99.25, 0.75, 79.25))
    assert found.height_at(np.array([[41.0, 1.0], [42.0, 1.0]])) == pytest.approx([20.0, 20.5])
    assert np.isnan(found.height_at(np.array([[9.0, 73.0]])))[0]
    assert "450000,5400000 m becomes x = y = 0" in caplog.text
    assert "cells of 2 m are resampled to 0.5 m" in caplog.text
    fine = import_terrain(far, resolution=0.1, crop=(10.0, 20.0, 10.0, 20.0))
    assert fine.extent == pytest.approx((9.95, 20.05, 9.95, 20.05))
    assert fine.height_at(np.array([[15.0, 15.0]]))[0] == pytest.approx(7.0 + 70.0, abs=1e-4)


@pytest.mark.parametrize("by_matrix", [False, True])
def test_a_south_row_that_comes_first_stays_in_the_south(tmp_path, caplog, by_matrix):
    south = slope()[::-1]
    scale = [(33550, "d", 3, (0.25, -0.25, 0.0)), (33922, "d", 6, (0, 0, 0, 100.0, 200.0, 0))]
    matrix = (0.25, 0, 0, 100.0, 0, 0.25, 0, 200.0, 0, 0, 1, 0, 0, 0, 0, 1)
    tags = [(34264, "d", 16, matrix)] if by_matrix else scale
    tifffile.imwrite(tmp_path / "dem.tif", south, extratags=[*tags, METRES])
    found = import_terrain(tmp_path / "dem.tif")
    assert found.extent == pytest.approx((100.0, 112.5, 200.0, 210.0))
    np.testing.assert_array_equal(found.heights, south)
    assert "holds its south row first" in caplog.text


def test_rows_from_east_to_west_are_refused(tmp_path):
    tags = [(33550, "d", 3, (-0.2, 0.2, 0.0)), (33922, "d", 6, (0, 0, 0, 0, 0, 0)), METRES]
    tifffile.imwrite(tmp_path / "west.tif", slope(), extratags=tags)
    with pytest.raises(InputError, match="runs from east to west"):
        import_terrain(tmp_path / "west.tif")


def test_degrees_and_turned_or_oblong_cells_are_refused(tmp_path):
    with pytest.raises(InputError, match="is in degrees; warp it to metres"):
        import_terrain(geotiff(tmp_path / "a.tif", slope(), 1e-5, (8.0, 47.0), DEGREES))
    turned = (34264, "d", 16, (0.2, 0.1, 0, 0, 0.1, -0.2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))
    tifffile.imwrite(tmp_path / "b.tif", slope(), extratags=[turned, METRES])
    with pytest.raises(InputError, match="turned against its axes"):
        import_terrain(tmp_path / "b.tif")
    tags = [(33550, "d", 3, (0.2, 0.3, 0.0)), (33922, "d", 6, (0, 0, 0, 0, 0, 0)), METRES]
    tifffile.imwrite(tmp_path / "c.tif", slope(), extratags=tags)
    with pytest.raises(InputError, match=r"cells of 0\.2 x 0\.3; a map has square ones"):
        import_terrain(tmp_path / "c.tif")


def test_a_plain_tiff_is_heights_or_grey_levels(tmp_path, caplog):
    levels = np.arange(0, 240, 20, dtype=np.uint8).reshape(3, 4)
    tifffile.imwrite(tmp_path / "grey.tif", levels)
    with pytest.raises(InputError, match="say its resolution"):
        import_terrain(tmp_path / "grey.tif")
    metres = import_terrain(tmp_path / "grey.tif", resolution=0.1, scale=0.01)
    np.testing.assert_allclose(metres.heights, 0.01 * levels[::-1])
    assert "holds whole numbers: each step is 0.01 m of height" in caplog.text
    grey = import_terrain(
        tmp_path / "grey.tif", resolution=0.1, z_min=1.0, z_max=2.0, zero_is_void=True
    )
    np.testing.assert_allclose(
        grey.heights[grey.heights > 0], (1.0 + levels / 255.0)[::-1][levels[::-1] > 0]
    )
    assert np.isnan(grey.heights[2, 0])
    assert "has 256 grey levels, 3.9 mm apart: heights between" in caplog.text
    with pytest.raises(InputError, match="z_min and z_max go together"):
        import_terrain(tmp_path / "grey.tif", resolution=0.1, z_min=1.0)


def test_what_gdal_states_is_heeded(tmp_path, caplog):
    """Scale and offset, the rounded lowest number of float32, masks, and a second band."""
    levels = np.arange(12, dtype=np.int16).reshape(3, 4)
    items = ("OFFSET", "offset", 5), ("SCALE", "scale", 0.01)
    text = "".join(f'<Item name="{n}" sample="0" role="{r}">{v}</Item>' for n, r, v in items)
    metadata = (42112, "s", 0, f"<GDALMetadata>{text}</GDALMetadata>", True)
    tifffile.imwrite(tmp_path / "scaled.tif", levels, extratags=[metadata])
    found = import_terrain(tmp_path / "scaled.tif", resolution=0.1).heights
    np.testing.assert_allclose(found, 5.0 + 0.01 * levels[::-1], rtol=1e-6)
    assert "states a scale of 0.01 and an offset of 5" in caplog.text
    lowest = np.ones((3, 4), np.float32)
    lowest[0, 0] = np.finfo(np.float32).min
    void = [(42113, "s", 0, "-3.4028235e+38", True)]
    tifffile.imwrite(tmp_path / "lowest.tif", lowest, extratags=void)
    found = import_terrain(tmp_path / "lowest.tif", resolution=0.1).heights
    np.testing.assert_array_equal(np.isnan(found), lowest[::-1] != 1.0)
    with tifffile.TiffWriter(tmp_path / "masked.tif") as out:
        out.write(np.ones((3, 4), np.float32))
        out.write(levels != 5, subfiletype=4, photometric="minisblack")
    found = import_terrain(tmp_path / "masked.tif", resolution=0.1).heights
    np.testing.assert_array_equal(np.isnan(found), levels[::-1] == 5)
    tifffile.imwrite(tmp_path / "two.tif", np.stack([lowest * 0, lowest], -1), planarconfig=1)
    import_terrain(tmp_path / "two.tif", resolution=0.1)
    assert "has 2 bands; the first one is read" in caplog.text


@pytest.mark.parametrize(
    "content", [b"", b"II*\0", b"II*\0\10\0\0\0\xff\xff" + bytes(40), b"no image"]
)
def test_broken_tiffs_are_refused(tmp_path, content):
    (tmp_path / "dem.tif").write_bytes(content)
    with pytest.raises(InputError, match=r"dem\.tif is damaged"):
        import_terrain(tmp_path / "dem.tif")


INFO = "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n"
BODY = (
    "string[] layers\nstring[] basic_layers\nstd_msgs/Float32MultiArray[] data\n"
    "uint16 outer_start_index\nuint16 inner_start_index\n"
)


def store_of(version):
    store = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
    header = "std_msgs/Header header\n"
    store.register(
        get_types_from_msg((header if version == 1 else "") + INFO, "grid_map_msgs/msg/GridMapInfo")
    )
    first = "" if version == 1 else header
    store.register(
        get_types_from_msg(
            first + "grid_map_msgs/GridMapInfo info\n" + BODY, "grid_map_msgs/msg/GridMap"
        )
    )
    return store


def message_of(store, version, layers, start=(0, 0), at=(3.0, -2.0)):
    """Return a GridMap of layers [x descending, y descending], moved round a circular buffer."""
    types = store.types
    make = lambda name: types[name.replace("/", "/msg/")]  # noqa: E731
    stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=2)
    header = {"stamp": stamp, "frame_id": "map"} | ({"seq": 0} if version == 1 else {})
    header = make("std_msgs/Header")(**header)
    pose = make("geometry_msgs/Pose")(
        position=make("geometry_msgs/Point")(x=at[0], y=at[1], z=0.0),
        orientation=make("geometry_msgs/Quaternion")(x=0.0, y=0.0, z=0.0, w=1.0),
    )
    rows, columns = next(iter(layers.values())).shape
    info = {"resolution": 0.1, "length_x": 0.1 * rows, "length_y": 0.1 * columns, "pose": pose}
    top = {} if version == 1 else {"header": header}
    info = make("grid_map_msgs/GridMapInfo")(**info, **({"header": header} if version == 1 else {}))
    dims = [
        make("std_msgs/MultiArrayDimension")(label=label, size=size, stride=stride)
        for label, size, stride in (
            ("column_index", columns, rows * columns),
            ("row_index", rows, rows),
        )
    ]
    data = [
        make("std_msgs/Float32MultiArray")(
            layout=make("std_msgs/MultiArrayLayout")(dim=dims, data_offset=0),
            data=np.roll(layer, start, axis=(0, 1)).T.reshape(-1).astype(np.float32),
        )
        for layer in layers.values()
    ]
    return make("grid_map_msgs/GridMap")(
        info=info, layers=list(layers), basic_layers=[], data=data,
        outer_start_index=start[0], inner_start_index=start[1], **top,
    )  # fmt: skip


def bag(folder: Path, kind: str, messages):
    """Write messages [(topic, layers, start)] as a bag; return its path."""
    version = 1 if kind == "bag" else 2
    store = store_of(version)
    if version == 1:
        path = folder / "map.bag"
        writer, serialise = Writer1(path), store.serialize_ros1
    else:
        path = folder / "map"
        plugin = StoragePlugin.SQLITE3 if kind == "db3" else StoragePlugin.MCAP
        writer = Writer2(path, version=9, storage_plugin=plugin)
        if kind == "mcap of packed chunks":
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        serialise = store.serialize_cdr
    name = "grid_map_msgs/msg/GridMap"
    with writer:
        connections = {}
        for time, (topic, layers, start) in enumerate(messages, start=1):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, name, typestore=store)
            message = message_of(store, version, layers, start)
            writer.write(connections[topic], time, serialise(message, name))
    return path


def ramp():
    """0.6 x 0.4 m; heights grow by 1 with x and by 10 with y, as a GridMap lays them out."""
    heights = np.arange(6.0)[::-1, None] + 10.0 * np.arange(4.0)[::-1]
    heights[1, 2] = np.nan
    return heights


@pytest.mark.parametrize("kind", ["bag", "db3", "mcap", "mcap of packed chunks"])
@pytest.mark.parametrize("start", [(0, 0), (2, 3), (5, 1)])
def test_a_grid_map_is_read_through_its_circular_buffer(tmp_path, kind, start):
    layers = {"variance": np.zeros((6, 4)), "elevation": ramp()}
    path = bag(tmp_path, kind, [("/grid_map", layers, start)])
    inside = [each for each in path.rglob("*") if each.suffix in (".mcap", ".db3")]
    for each in [path, *inside]:
        found = import_terrain(each)
        assert found.shape == (4, 6)
        assert found.resolution == 0.1
        assert found.extent == pytest.approx((2.7, 3.3, -2.2, -1.8))
        np.testing.assert_array_equal(found.heights, ramp()[::-1, ::-1].T)
    if kind == "mcap of packed chunks":
        assert b"zstd" in inside[0].read_bytes()


def ros1_mcap(path, packing=""):
    """Write a GridMap message of ROS 1 as MCAP, record by record (mcap.dev/spec)."""
    store, name = store_of(1), "grid_map_msgs/msg/GridMap"
    raw = bytes(store.serialize_ros1(message_of(store, 1, {"elevation": ramp()}, (0, 0)), name))
    definition = store.generate_msgdef(name)[0]

    def text(words):
        return struct.pack("<I", len(words.encode())) + words.encode()

    def record(kind, body):
        return struct.pack("<BQ", kind, len(body)) + body

    schema = struct.pack("<H", 1) + text("grid_map_msgs/GridMap") + text("ros1msg")
    channel = struct.pack("<HH", 0, 1) + text("/map") + text("ros1") + struct.pack("<I", 0)
    message = struct.pack("<HIQQ", 0, 0, 1, 1) + raw
    chunk = record(3, schema + text(definition)) + record(4, channel) + record(5, message)
    packed = zstd.compress(chunk) if packing == "zstd" else chunk
    head = struct.pack("<QQQI", 1, 1, len(chunk), 0) + text(packing)
    chunks = record(6, head + struct.pack("<Q", len(packed)) + packed)
    end = record(15, bytes(4)) + record(2, bytes(20))
    mark = b"\x89MCAP0\r\n"
    path.write_bytes(mark + record(1, text("ros1") + text("a test")) + chunks + end + mark)
    return path


@pytest.mark.parametrize("packing", ["", "zstd"])
def test_an_mcap_with_messages_of_ros_1_is_read(tmp_path, packing, caplog):
    found = import_terrain(ros1_mcap(tmp_path / "map.mcap", packing))
    wanted = import_terrain(bag(tmp_path, "bag", [("/map", {"elevation": ramp()}, (0, 0))]))
    np.testing.assert_array_equal(found.heights, wanted.heights)
    assert found.extent == pytest.approx(wanted.extent)
    assert "map.mcap is read on the topic /map, layer elevation" in caplog.text
    with pytest.raises(InputError, match="has no map on the topic /other; there are /map"):
        import_terrain(tmp_path / "map.mcap", topic="/other")


@pytest.mark.parametrize("kept", [40, 300, 800])
def test_a_cut_mcap_of_ros_1_is_refused(tmp_path, kept):
    path = ros1_mcap(tmp_path / "map.mcap")
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(InputError, match=r"map\.mcap"):
        import_terrain(path)


def test_topic_and_layer_are_chosen_or_asked_for(tmp_path, caplog):
    low, high = {"elevation": ramp()}, {"elevation": ramp() + 100.0, "smooth": ramp() + 200.0}
    path = bag(tmp_path, "bag", [("/a", low, (0, 0)), ("/b", low, (0, 0)), ("/b", high, (1, 1))])
    with pytest.raises(InputError, match="several topics: say --topic, one of /a, /b"):
        import_terrain(path)
    assert np.nanmax(import_terrain(path, topic="/a").heights) == 35.0
    assert np.nanmax(import_terrain(path, topic="/b").heights) == 135.0
    assert "topic /b, layer elevation, the last of 2 messages" in caplog.text
    assert np.nanmax(import_terrain(path, topic="/b", layer="smooth").heights) == 235.0
    with pytest.raises(InputError, match="no layer rough; there are elevation, smooth"):
        import_terrain(path, topic="/b", layer="rough")
    other = bag(tmp_path, "mcap", [("/c", {"one": ramp(), "two": ramp()}, (0, 0))])
    with pytest.raises(InputError, match="say --layer, one of one, two"):
        import_terrain(other)


@pytest.mark.parametrize("name", ["a.bag", "a.mcap", "a.db3"])
def test_broken_bags_are_refused(tmp_path, name):
    (tmp_path / name).write_bytes(b"#ROSBAG V2.0\n" + bytes(100))
    with pytest.raises(InputError, match=f"{name} is damaged"):
        import_terrain(tmp_path / name)
    with pytest.raises(InputError, match="does not exist"):
        import_terrain(tmp_path / f"no_{name}")
