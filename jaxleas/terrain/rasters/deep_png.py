"""PNG images of 16 bits in colour or with alpha, which Pillow reads as 8 bits.

The filters of a row need the pixel to the left and the row above. Pixels on a diagonal need none
of each other, so that whole diagonals are computed at once.
"""

import zlib

import numpy as np
from jaxtyping import Int, UInt16

CHANNELS = {2: 3, 4: 2, 6: 4}
"""Number of channels of each colour type with several: RGB, grey and alpha, RGBA."""
MAX_BYTES = 2**28  # unpacked
_PASSES = (
    *((0, 0, 8, 8), (0, 4, 8, 8), (4, 0, 8, 4), (0, 2, 4, 4)),
    *((2, 0, 4, 2), (0, 1, 2, 2), (1, 0, 2, 1)),
)
"""First row and column, and steps of rows and columns, of each pass of an interlaced image."""


def decode_deep_colour(content: bytes) -> UInt16[np.ndarray, "rows columns C"]:
    """Return the pixels of a PNG of 16 bits: colours or grey, then alpha.

    Raises:
        ValueError: the image is damaged, or too large.
        zlib.error: its packed data are damaged.
    """
    width, height = int.from_bytes(content[16:20], "big"), int.from_bytes(content[20:24], "big")
    channels = CHANNELS.get(content[25])
    if channels is None or content[26] or content[27] or content[28] > 1 or not width * height:
        raise ValueError("its header is impossible")
    if 2 * channels * width * height > MAX_BYTES:
        raise ValueError(f"{width} x {height} pixels of {16 * channels} bits are too many")
    packed, clear = _chunks(content)
    pixels = np.zeros((height, width, channels), np.uint16)
    passes = _PASSES if content[28] else ((0, 0, 1, 1),)
    parts = [pixels[row::down, column::right] for row, column, down, right in passes]
    size = sum(part.shape[0] * (1 + 2 * channels * part.shape[1]) for part in parts if part.size)
    unpacker = zlib.decompressobj()
    data = np.frombuffer(unpacker.decompress(packed, size), np.uint8)
    if len(data) < size:
        raise ValueError("its pixels are cut short")
    for part in parts:
        if part.size:
            lines = part.shape[0] * (1 + 2 * channels * part.shape[1])
            part[:] = _unfiltered(data[:lines].reshape(part.shape[0], -1), 2 * channels)
            data = data[lines:]
    if channels != 3:
        return pixels
    opaque = np.full((height, width, 1), 65535, np.uint16)
    if clear is not None:
        opaque[(pixels == clear).all(axis=-1)] = 0
    return np.concatenate([pixels, opaque], axis=-1)


def _chunks(content: bytes) -> tuple[bytes, np.ndarray | None]:
    """Return the packed pixels, and the colour that is transparent."""
    packed, clear, at = [], None, 8
    while at + 12 <= len(content):
        length = int.from_bytes(content[at : at + 4], "big")
        body = content[at + 8 : at + 8 + length]
        kind, stated = content[at + 4 : at + 8], content[at + 8 + length : at + 12 + length]
        if zlib.crc32(kind + body) != int.from_bytes(stated, "big"):
            raise ValueError("a checksum is wrong")
        if kind == b"IDAT":
            packed.append(body)
        elif kind == b"tRNS" and len(body) == 6:
            clear = np.frombuffer(body, ">u2")
        elif kind == b"IEND":
            break
        at += 12 + length
    return b"".join(packed), clear


def _unfiltered(lines: Int[np.ndarray, "R L"], size: int) -> UInt16[np.ndarray, "R C K"]:
    """Return the pixels of filtered lines, each a byte for its filter and then `size` per pixel."""
    kind = lines[:, :1].astype(np.int16)
    if (kind > 4).any():
        raise ValueError("a row has an unknown filter")
    raw = lines[:, 1:].reshape(len(lines), -1, size).astype(np.int16)
    rows, columns = raw.shape[:2]
    done = np.zeros((rows + 1, columns + 1, size), np.int16)  # with zeros above and to the left
    for step in range(rows + columns - 1):
        row = np.arange(max(0, step - columns + 1), min(rows, step + 1))
        column = step - row
        left, above = done[row + 1, column], done[row, column + 1]
        corner = done[row, column]
        guess = left + above - corner
        far = [np.abs(guess - each) for each in (left, above, corner)]
        paeth = np.where(
            (far[0] <= far[1]) & (far[0] <= far[2]), left, np.where(far[1] <= far[2], above, corner)
        )
        options = [np.zeros_like(left), left, above, (left + above) // 2, paeth]
        predicted = np.choose(kind[row], options)
        done[row + 1, column + 1] = (raw[row, column] + predicted) & 255
    bytes_of = done[1:, 1:].astype(np.uint16).reshape(rows, columns, size // 2, 2)
    return bytes_of[..., 0] * 256 + bytes_of[..., 1]
