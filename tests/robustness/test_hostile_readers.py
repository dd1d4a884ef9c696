"""Files made to harm: refused by a sentence, before memory is taken for what they claim."""

import io
import json
import struct
import tracemalloc
import warnings
import zipfile
import zlib

import numpy as np
import pytest

from jaxleas.files import parse_json, read_json, read_npz, require_version
from jaxleas.files.json_text import MAX_DEPTH
from jaxleas.types import InputError


def npy(header: str, content: bytes = b"") -> bytes:
    text = header.encode() + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content


def archive(path, members, packing=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(path, "w", packing) as out:
        for name, content in members.items():
            out.writestr(name, content)
    return path


def peak_of(action) -> int:
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as caught:
            action()
        assert "\n" not in str(caught.value)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    "header",
    [
        "{'descr': '<f4', 'fortran_order': False, 'shape': (4000000000, 1000000), }",
        "{'descr': '<U1000000000', 'fortran_order': False, 'shape': (4,), }",
        "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
        "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (1,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (-1,), }",
        "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 1, 1, 1, 1, 1, 1, 1), }",
        "__import__('os').abort()",
        "(" * 9000,
    ],
)
def test_headers_that_lie_cost_nothing(tmp_path, header):
    path = archive(tmp_path / "x.npz", {"a.npy": npy(header, b"\0" * 4)})
    assert peak_of(lambda: read_npz(path, ("a",))) < 2_000_000


def test_a_member_that_unpacks_to_more_than_it_says_is_not_unpacked(tmp_path):
    header = npy("{'descr': '|u1', 'fortran_order': False, 'shape': (100,), }")
    content = header + b"\0" * 50_000_000
    path = archive(tmp_path / "x.npz", {"a.npy": content})
    claimed = struct.pack("<I", len(header) + 100)
    whole = path.read_bytes().replace(struct.pack("<I", len(content)), claimed)
    path.write_bytes(whole)
    assert peak_of(lambda: read_npz(path, ("a",))) < 2_000_000


def test_too_much_is_refused_before_it_is_unpacked(tmp_path):
    path = archive(tmp_path / "x.npz", {"a.npy": b"\0" * 30_000_000})
    assert peak_of(lambda: read_npz(path, ("a",), max_bytes=10_000_000)) < 2_000_000


@pytest.mark.parametrize("names", [["../a.npy", "/etc/a.npy"], ["a"], ["a.npy", "a.npy"]])
def test_strange_names_never_become_files(tmp_path, names):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.zeros(1))
    path = tmp_path / "x.npz"
    with warnings.catch_warnings(), zipfile.ZipFile(path, "w") as out:
        warnings.simplefilter("ignore")  # of two members of one name
        for name in names:
            out.writestr(name, stream.getvalue())
    with pytest.raises(InputError):
        read_npz(path, ("a",))
    assert [each.name for each in tmp_path.iterdir()] == ["x.npz"]


def test_encrypted_and_exotic_archives_are_refused(tmp_path):
    for packing in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        path = archive(tmp_path / "x.npz", {"a.npy": b"x" * 100}, packing)
        with pytest.raises(InputError, match=f"compressed by method {packing}"):
            read_npz(path, ())


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[" * 5000 + "]" * 5000, "nests"),
        ("[" * (MAX_DEPTH + 2) + "]" * (MAX_DEPTH + 2), f"more than {MAX_DEPTH} deep"),
        ("9" * 5000, "99999999999999999... which is neither|holds 99999999999999999"),
        ("1e999", "holds 1e999"),
        ('{"a": "\\ud800"}', "lone surrogate"),
        ('{"\\udfff": 1}', "lone surrogate"),
        ("[" + "[]," * 4_100_000 + "[]]", "more than 4000000 lists"),
        ('"' + "x" * (65 * 2**20) + '"', "bytes of JSON, more than"),
    ],
)
def test_json_out_of_proportion_is_refused(text, sentence):
    with pytest.raises(InputError, match=sentence):
        parse_json(text.encode(), "x.json")


def test_what_is_deep_but_not_too_deep_is_read(tmp_path):
    value = 1
    for _ in range(MAX_DEPTH - 1):
        value = [value]
    (tmp_path / "x.json").write_text(json.dumps(value))
    assert read_json(tmp_path / "x.json") == value
    assert parse_json('"\\ud83d\\ude00"', "x") == "\U0001f600"


def test_a_file_of_another_version_is_named_with_both(tmp_path):
    require_version({}, 1, "x")
    require_version({"version": 2}, 2, "x")
    for content in ({"version": 3}, {"version": "2"}, {"version": True}, {}):
        with pytest.raises(InputError, match=r"x is of version .*; this jaxleas reads version 2"):
            require_version(content, 2, "x")


def test_a_picture_that_claims_to_be_vast_costs_nothing(tmp_path):
    from jaxleas.terrain import import_png

    def chunk(kind: bytes, body: bytes) -> bytes:
        tail = struct.pack(">I", zlib.crc32(kind + body))
        return struct.pack(">I", len(body)) + kind + body + tail

    header = struct.pack(">IIBBBBB", 60_000, 60_000, 16, 0, 0, 0, 0)
    path = tmp_path / "x.png"
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IEND", b""))
    assert peak_of(lambda: import_png(path, 0.1, 0.0, 1.0)) < 5_000_000


def test_a_mesh_that_claims_four_billion_triangles_costs_nothing(tmp_path):
    from jaxleas.terrain import import_mesh

    path = tmp_path / "x.stl"
    path.write_bytes(b"x".ljust(80) + struct.pack("<I", 4_000_000_000) + b"\0" * 500)
    assert peak_of(lambda: import_mesh(path)) < 5_000_000
