"""Arrays of an untrusted .npz: every claim of the file is checked before memory is allocated.

NumPy's own reader allocates the memory that a header asks for before it has read a byte, and raises
a dozen kinds of exceptions for damaged files. Plain arrays are simple: a zip archive of members
`NAME.npy`, each with a short header and the numbers.
"""

import math
import os
import re
import zipfile
import zlib
from pathlib import Path
from typing import IO

import numpy as np

from jaxleas.types import InputError

MAX_BYTES = 2**30  # a larger array file is a mistake or an attack, not a map
MAX_MEMBERS = 10_000
MAX_DIMENSIONS = 8
MAX_HEADER = 10_000
KINDS = "biufSU"  # no Python objects, no records, no dates

# Exceptions that zipfile and zlib raise for damaged bytes.
_DAMAGES = (
    EOFError,
    NotImplementedError,  # an unusual compression or encryption
    OSError,
    OverflowError,
    RuntimeError,  # an encrypted member
    ValueError,
    zipfile.BadZipFile,
    zlib.error,
)
_HEADER = re.compile(
    rb"\{\s*'descr':\s*'([<>|=]?[a-zA-Z]\d*)',\s*'fortran_order':\s*(True|False),\s*"
    rb"'shape':\s*\(([\d,\s]*)\),?\s*\}\s*"
)


class DamagedError(Exception):
    """The bytes are not a plain .npz; the message says why."""


def read_arrays(
    path: str | Path, max_bytes: int | None = MAX_BYTES, only: str | None = None
) -> dict[str, np.ndarray]:
    """Return the arrays of a .npz file, each checked against its checksum.

    Args:
        path: path of an existing file.
        max_bytes: largest total size of the unpacked arrays; None: uncompressed arrays of any size
            are read, and compressed ones are refused.
        only: name of the one array to read; None: all.

    Raises:
        DamagedError: the file is not a plain .npz.
        InputError: the file unpacks to more than `max_bytes`.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            _require_bounds(path, entries, max_bytes)
            names = [_name(entry) for entry in entries]
            if len(set(names)) < len(names):
                raise DamagedError("it holds two arrays of one name")
            return {
                name: _member(archive, entry)
                for name, entry in zip(names, entries, strict=True)
                if only in (None, name)
            }
    except _DAMAGES as error:
        raise DamagedError(_words(error)) from error


def _words(error: Exception) -> str:
    return ascii(str(error) or type(error).__name__)[1:-1][:100]


def _require_bounds(
    path: str | Path, entries: list[zipfile.ZipInfo], max_bytes: int | None
) -> None:
    size = sum(entry.file_size for entry in entries)
    if len(entries) > MAX_MEMBERS:
        raise InputError(f"{path} holds {len(entries)} arrays, more than the {MAX_MEMBERS} read")
    if max_bytes is not None and size > max_bytes:
        raise InputError(f"{path} unpacks to {size} bytes, more than the {max_bytes} allowed")
    if max_bytes is None and size > Path(path).stat().st_size:
        raise DamagedError("its arrays are larger than itself")
    for entry in entries:
        stored = entry.compress_type == zipfile.ZIP_STORED
        if max_bytes is None and not (stored and entry.file_size == entry.compress_size):
            raise DamagedError("an array is compressed, which none of this file should be")
        if not stored and entry.compress_type != zipfile.ZIP_DEFLATED:
            raise DamagedError(f"an array is compressed by method {entry.compress_type}")


def _name(entry: zipfile.ZipInfo) -> str:
    name = entry.filename.removesuffix(".npy")
    if name == entry.filename:
        raise DamagedError(f"it holds {ascii(entry.filename)[:60]}, which is no array")
    return name


def read_plain_array(path: str | Path) -> np.ndarray:
    """Return the array of a .npy file; bytes after its numbers are passed over.

    Raises:
        DamagedError: the file is no plain array.
    """
    try:
        with Path(path).open("rb") as stream:
            size = os.fstat(stream.fileno()).st_size
            return _array(stream, size, Path(path).name, tail=True)
    except _DAMAGES as error:
        raise DamagedError(_words(error)) from error


def _member(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> np.ndarray:
    with archive.open(entry) as stream:
        return _array(stream, entry.file_size, entry.filename)


def _array(stream: IO[bytes], size: int, name: str, tail: bool = False) -> np.ndarray:
    kind, shape, fortran, begin = _header(stream.read(12), stream)
    count = math.prod(shape)
    end = begin + count * kind.itemsize
    if end > size or (end < size and not tail):
        raise DamagedError(f"{name} is {size} bytes, which do not make shape {shape}")
    # Only the stated size: `read()` would unpack all that the member holds before cutting it.
    content = stream.read(count * kind.itemsize)
    if len(content) != count * kind.itemsize:
        raise DamagedError(f"{name} is cut short")
    flat = np.frombuffer(bytearray(content), kind, count)  # a bytearray is writable
    array = flat.reshape(shape, order="F" if fortran else "C")
    if not kind.isnative:  # JAX accepts only the native byte order
        array = array.astype(kind.newbyteorder("="))
    if kind.kind == "U":
        _require_unicode(array, name)
    return array


def _header(start: bytes, stream: IO[bytes]) -> tuple[np.dtype, tuple[int, ...], bool, int]:
    """Return type, shape, order and length of the header of an array."""
    if len(start) < 12 or start[:6] != b"\x93NUMPY" or start[6] not in (1, 2, 3):
        raise DamagedError("a member is no array of NumPy's")
    wide = start[6] > 1
    length = int.from_bytes(start[8:12] if wide else start[8:10], "little")
    if length > MAX_HEADER:
        raise DamagedError(f"an array has a header of {length} bytes")
    begun = b"" if wide else start[10:12]
    text = begun + stream.read(max(length - len(begun), 0))
    found = _HEADER.fullmatch(text)
    if found is None:
        raise DamagedError("an array is no plain one: of Python objects or records, or damaged")
    try:
        kind = np.dtype(found[1].decode())
    except TypeError as error:
        raise DamagedError(f"an array is of the unknown type {found[1].decode()}") from error
    numbers = found[3].replace(b",", b" ").split()
    shape = tuple(int(each) for each in numbers)
    # bfloat16 is written as two bytes without meaning to NumPy.
    if kind.kind not in KINDS and kind.str != "|V2":
        raise DamagedError(f"an array is of type {kind}: numbers, truth values and text are read")
    if len(shape) > MAX_DIMENSIONS or (kind.itemsize == 0 and kind.kind not in "SU"):
        raise DamagedError(f"an array has the shape {shape} of {kind}")
    return kind, shape, found[2] == b"True", (12 if wide else 10) + length


def _require_unicode(array: np.ndarray, name: str) -> None:
    codes = array.reshape(-1).view(np.uint32) if array.size and array.itemsize else np.zeros(0)
    if (codes > 0x10FFFF).any() or ((codes >= 0xD800) & (codes < 0xE000)).any():
        raise DamagedError(f"{name} holds text that is not Unicode")
