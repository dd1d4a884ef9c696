"""PNG images of every colour mode and depth have the heights that their levels state."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from jaxleas.terrain import import_png, import_terrain
from jaxleas.terrain.rasters.deep_png import decode_deep_colour
from jaxleas.types import InputError

CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
PASSES = [
    *((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4)),
    *((2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)),
]


def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def lines_of(samples, depth, filters=None):
    """Return the packed rows of an image, each filtered by a filter of its own."""
    rows, _columns = samples.shape[:2]
    flat = samples.reshape(rows, -1)
    if depth == 16:
        raw = flat.astype(">u2").view(np.uint8)
    elif depth == 8:
        raw = flat.astype(np.uint8)
    else:
        bits = ((flat[..., None] >> np.arange(depth)[::-1]) & 1).reshape(rows, -1)
        raw = np.packbits(bits.astype(np.uint8), axis=1)
    size = max(1, depth * samples.shape[2] // 8)
    out, above = b"", np.zeros(raw.shape[1] + size, int)
    for row, line in enumerate(raw):
        kind = 0 if filters is None else int(filters[row % len(filters)])
        here = np.concatenate([np.zeros(size, int), line])
        left, over, corner = here[:-size], above[size:], above[:-size]
        guess = left + over - corner
        far = [abs(guess - each) for each in (left, over, corner)]
        paeth = np.where(
            (far[0] <= far[1]) & (far[0] <= far[2]), left, np.where(far[1] <= far[2], over, corner)
        )
        predicted = (0 * left, left, over, (left + over) // 2, paeth)[kind]
        out += bytes([kind]) + ((line - predicted) % 256).astype(np.uint8).tobytes()
        above = here
    return out


def png(samples, kind, depth, extra=(), filters=None, interlaced=False):
    rows, columns = samples.shape[:2]
    head = struct.pack(">IIBBBBB", columns, rows, depth, kind, 0, 0, int(interlaced))
    parts = [samples[a::c, b::d] for a, b, c, d in PASSES] if interlaced else [samples]
    data = b"".join(lines_of(part, depth, filters) for part in parts if part.size)
    chunks = [
        chunk(b"IHDR", head),
        *extra,
        chunk(b"IDAT", zlib.compress(data)),
        chunk(b"IEND", b""),
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


@pytest.mark.parametrize(
    ("kind", "depth"),
    [(0, 1), (0, 2), (0, 4), (0, 8), (0, 16), (2, 8), (2, 16), (3, 2), (3, 8), (4, 8), (4, 16),
     (6, 8), (6, 16)],
)  # fmt: skip
def test_every_mode_and_depth_has_its_heights(tmp_path, kind, depth):
    rng = np.random.default_rng(depth)
    top = 2**depth - 1
    level = rng.integers(0, top + 1, (7, 9))
    samples = np.repeat(level[..., None], CHANNELS[kind], axis=2)
    clear = np.zeros(level.shape, bool)
    extra = []
    expected = level / top
    if kind == 3:
        palette = np.repeat(rng.integers(0, 256, (top + 1, 1)), 3, axis=1)
        extra = [chunk(b"PLTE", palette.astype(np.uint8).tobytes())]
        expected = palette[level, 0] / 255
    if kind in (4, 6):
        samples[..., -1] = top
        clear[2:4, 3:5] = True
        samples[clear, -1] = top // 2 - 1
    (tmp_path / "image.png").write_bytes(png(samples, kind, depth, extra))
    heights = import_png(tmp_path / "image.png", 0.1, -1.0, 2.0).heights[::-1]
    np.testing.assert_array_equal(np.isnan(heights), clear)
    np.testing.assert_allclose(heights[~clear], (-1.0 + 3.0 * expected)[~clear], atol=1e-6)


@pytest.mark.parametrize("kind", [2, 4, 6])
@pytest.mark.parametrize("interlaced", [False, True])
def test_16_bits_of_colour_are_decoded_through_every_filter(kind, interlaced):
    rng = np.random.default_rng(kind)
    for shape in ((1, 1), (3, 2), (23, 17)):
        smooth = np.cumsum(rng.integers(0, 900, (*shape, CHANNELS[kind])), axis=0) % 65536
        content = png(smooth, kind, 16, filters=[0, 1, 2, 3, 4, 4, 3], interlaced=interlaced)
        decoded = decode_deep_colour(content)
        np.testing.assert_array_equal(decoded[..., : CHANNELS[kind]], smooth)
        half = np.asarray(Image.open(__import__("io").BytesIO(content)).convert("RGBA"))
        np.testing.assert_array_equal(half[..., 0], smooth[..., 0] // 256)  # Pillow keeps 8 bits


@pytest.mark.parametrize(("kind", "depth"), [(0, 8), (0, 16), (2, 8), (2, 16), (3, 8)])
def test_a_transparent_colour_is_no_ground(tmp_path, kind, depth):
    level = np.arange(12).reshape(3, 4)
    samples = np.repeat(level[..., None], CHANNELS[kind], axis=2)
    extra = [chunk(b"PLTE", bytes(range(36)))] if kind == 3 else []
    transparent = b"\xff\xff\xff\xff\xff\0" if kind == 3 else b"\0\5" * CHANNELS[kind]
    (tmp_path / "image.png").write_bytes(
        png(samples, kind, depth, [*extra, chunk(b"tRNS", transparent)])
    )
    heights = import_png(tmp_path / "image.png", 0.1, 0.0, 1.0).heights[::-1]
    np.testing.assert_array_equal(np.isnan(heights), level == 5)


def test_colours_are_weighed_as_grey_and_coarse_steps_are_said(tmp_path, caplog):
    samples = np.zeros((4, 4, 3), int)
    samples[..., 0], samples[0, 0] = 100, (0, 0, 200)
    (tmp_path / "image.png").write_bytes(png(samples, 2, 8))
    heights = import_terrain(tmp_path / "image.png", resolution=0.1, z_min=0.0, z_max=2.55).heights
    assert heights[-1, 1] == pytest.approx(0.299, abs=1e-4)
    assert heights[-1, 0] == pytest.approx(0.228, abs=1e-4)
    assert "is coloured: its colours are weighed as grey" in caplog.text
    assert "has 256 grey levels, 10 mm apart" in caplog.text
    caplog.clear()
    Image.fromarray(np.arange(16, dtype=np.uint16).reshape(4, 4)).save(tmp_path / "deep.png")
    import_png(tmp_path / "deep.png", 0.1, 0.0, 1.0)
    assert caplog.messages == [f"{tmp_path}/deep.png has 65536 grey levels, 0.015 mm apart"]


def test_broken_deep_images_are_refused(tmp_path):
    whole = png(np.full((9, 9, 3), 7), 2, 16)
    path = tmp_path / "image.png"
    for broken in (
        whole[:60],
        whole[:-30],
        whole.replace(b"IDAT", b"IDAX"),
        whole[:25] + b"\x05" + whole[26:],
    ):
        path.write_bytes(broken)
        with pytest.raises(InputError, match="not a readable PNG"):
            import_png(path, 0.1, 0.0, 1.0)
