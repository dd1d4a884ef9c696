"""Mutations of a file: of its bytes, and of what it holds (JSON, YAML, arrays, ONNX, PNG)."""

import copy
import io
import json
import random
import struct
import zipfile
import zlib
from collections.abc import Callable
from typing import Any

import numpy as np
import yaml

Mutation = Callable[[random.Random, bytes], bytes]

_STRANGE: tuple[Any, ...] = (
    *(0, -1, 1, 2, 7, 255, 2**31, 2**63, -(2**63), 10**30, 10**400),
    *(1e308, -1e308, 1e-320, 0.5, 1e6),
    *(True, False, None, "", "x", "0", "1e9", "a" * 5000, "LF", "talos", "nan"),
    *("../../etc/passwd", "/dev/zero", "\u0000", "\ud800"),
    *([], {}, [[]], [None], [0] * 3, [1e9] * 3, {"": {}}, [[0, 0, 0]]),
)
_WORDS = (
    *(b"nan", b"inf", b"-1", b"0", b"99999999999999999999", b"1e999", b"1/2/3", b"1//", b"/", b""),
    *(b"\n", b"f 1 2 3\n", b"f 1\n", b"facet", b"mtllib /etc/passwd\n", b"\xff\xfe", b"x"),
)


def mutate_bytes(draw: random.Random, whole: bytes) -> bytes:
    """Return the bytes with some flipped, cut, repeated, blanked or replaced."""
    found = bytearray(whole)
    for _ in range(draw.choice((1, 1, 1, 2, 5, 20))):
        if not found:
            break
        at = draw.randrange(len(found))
        length = draw.choice((1, 2, 4, 8, 64, len(found) // 3 + 1))
        match draw.randrange(8):
            case 0 | 1:
                found[at] ^= 1 << draw.randrange(8)
            case 2:
                del found[at:]
            case 3:
                del found[at : at + length]
            case 4:
                found[at:at] = found[at : at + length]
            case 5:
                found[at : at + length] = bytes(len(found[at : at + length]))
            case 6:
                found[at : at + 4] = draw.choice((b"\xff" * 4, b"\0\0\0\x80", draw.randbytes(4)))
            case _:
                found[at : at + length] = draw.randbytes(min(length, 64))
    return bytes(found)


def splice(draw: random.Random, whole: bytes, other: bytes) -> bytes:
    """Return the beginning of one file and the end of another."""
    return whole[: draw.randrange(len(whole) + 1)] + other[draw.randrange(len(other) + 1) :]


def mutate_value(draw: random.Random, value: Any) -> Any:
    """Return a plain value with some of it deleted, swapped, renamed, or made something strange."""
    value = copy.deepcopy(value)
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        places = _places(value)
        if not places:
            return draw.choice(_STRANGE)
        parent, key = draw.choice(places)
        match draw.randrange(9):
            case 0:
                del parent[key]
            case 1 if isinstance(parent, dict):
                parent[draw.choice((key + "x", key.upper(), "version", "format", "extends"))] = (
                    parent.pop(key)
                )
            case 2:
                there, other = draw.choice(places)
                parent[key] = copy.deepcopy(there[other]) if _holds(there, other) else None
            case 3:
                parent[key] = [parent[key]]
            case 4 if isinstance(parent[key], list):
                parent[key] = parent[key] * draw.choice((0, 2, 50))
            case 5 if type(parent[key]) in (int, float):
                parent[key] *= draw.choice((-1, 0, 1e-9, 1e9, 1 + 1e-6, 1e300))
            case 6:
                parent[key] = _nested(draw.choice((3, 60, 150, 400)))
            case _:
                parent[key] = copy.deepcopy(draw.choice(_STRANGE))
    return value


def mutate_json(draw: random.Random, whole: bytes) -> bytes:
    """Return JSON with another value, sometimes with what JSON is not."""
    text = json.dumps(mutate_value(draw, json.loads(whole)))
    if draw.random() < 0.1:
        number = draw.choice(("NaN", "-Infinity", "1e999", "9" * 5000, "-0", "1E400", '"\\ud800"'))
        text = text.replace(draw.choice("0123456789"), number, 1)
    return text.encode(errors="surrogatepass")


def mutate_lines(draw: random.Random, whole: bytes) -> bytes:
    """Return JSON lines with one of them mutated."""
    lines = whole.splitlines()
    at = draw.randrange(len(lines))
    lines[at] = mutate_json(draw, lines[at])
    return b"\n".join(lines) + b"\n"


def mutate_yaml(draw: random.Random, whole: bytes) -> bytes:
    """Return YAML with another value, or with aliases, tags and merges."""
    evil = (
        "!!python/object/apply:os.system ['touch /tmp/owned']",
        "&a [x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a]\nc: [*b, *b, *b, *b]",
        "&a [*a]",
        "{<<: {a: 1}}",
        "{? [1, 2] : 3}",
        "[{2020-01-01: 1}]",
        "[{.nan: 1}, {? {a: b} : c}]",
        "!!timestamp 2020-99-99",
        "!!binary aaa",
        "!!set {a, b}",
        "1:99999999999999999999:3",
        "0x" + "f" * 5000,
        "9" * 5000,
        ".inf",
        '"\\ud800"',
        "{" * 3000,
        "- " * 3000,
    )
    stated = yaml.safe_load(whole)
    if draw.random() < 0.3:
        return (
            whole
            + f"\n{draw.choice(('seed', 'ppo', 'q', 'extends'))}: ".encode()
            + draw.choice(evil).encode(errors="surrogatepass")
        )
    value = mutate_value(draw, stated)
    try:
        return yaml.safe_dump(value).encode(errors="surrogatepass")
    except (RecursionError, ValueError):  # too deep, or a number of too many digits for PyYAML
        return json.dumps(value, default=str).encode()


def mutate_npz(draw: random.Random, whole: bytes) -> bytes:
    """Return an archive with another array, a lying header, or an evil member."""
    with np.load(io.BytesIO(whole)) as archive:
        arrays = {name: archive[name] for name in archive.files}
    name = draw.choice(list(arrays))
    out = io.BytesIO()
    packing = draw.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))
    with zipfile.ZipFile(out, "w", packing) as archive:
        for each, array in arrays.items():
            buffer = io.BytesIO()
            changed = _mutate_array(draw, array) if each == name else array
            np.lib.format.write_array(buffer, changed)
            content = buffer.getvalue()
            if each == name and draw.random() < 0.4:
                content = _mutate_header(draw, content)
            member = f"{each}.npy"
            if each == name and draw.random() < 0.1:
                member = draw.choice(("../x.npy", "x", "metadata.npy", "é.npy", "a/b.npy", ".npy"))
            if each != name or draw.random() < 0.9:
                archive.writestr(member, content)
        if draw.random() < 0.02:
            archive.writestr("bomb.npy", bytes(30_000_000), zipfile.ZIP_DEFLATED)
    return out.getvalue()


def mutate_png(draw: random.Random, whole: bytes) -> bytes:
    """Return a PNG with another header or another chunk, checksums right."""
    chunks, at = [], 8
    while at + 8 <= len(whole):
        (length,) = struct.unpack(">I", whole[at : at + 4])
        chunks.append([whole[at + 4 : at + 8], bytearray(whole[at + 8 : at + 8 + length])])
        at += 12 + length
    chunk = draw.choice(chunks)
    if chunk[0] == b"IHDR" or draw.random() < 0.4:
        chunk = chunks[0]
        size = draw.choice((0, 1, 2, 5000, 40_000, 2**31 - 1, 2**32 - 1))
        position = draw.choice((0, 4))
        chunk[1][position : position + 4] = struct.pack(">I", size)
        if draw.random() < 0.5:
            chunk[1][8 + draw.randrange(5)] = draw.choice((0, 1, 2, 3, 4, 6, 8, 16, 255))
    elif chunk[1]:
        chunk[1] = bytearray(mutate_bytes(draw, bytes(chunk[1])))
    if draw.random() < 0.2:
        kind = draw.choice((b"zTXt", b"iTXt", b"iCCP", b"tEXt", b"eXIf", b"acTL", b"tRNS"))
        body = b"k\0\0" + zlib.compress(bytes(draw.choice((10, 5_000_000))))
        chunks.insert(draw.randrange(1, len(chunks)), [kind, bytearray(body)])
    out = bytearray(whole[:8])
    for kind, body in chunks:
        out += struct.pack(">I", len(body)) + kind + body
        out += struct.pack(">I", zlib.crc32(kind + bytes(body)))
    return bytes(out)


def mutate_text(draw: random.Random, whole: bytes) -> bytes:
    """Return a text with some of its words replaced by others."""
    words = whole.split(b" ")
    for _ in range(draw.choice((1, 1, 2, 10))):
        words[draw.randrange(len(words))] = draw.choice(_WORDS)
    return b" ".join(words)


def mutate_stl(draw: random.Random, whole: bytes) -> bytes:
    """Return a binary STL that claims another number of triangles, or has strange corners."""
    found = bytearray(whole)
    if draw.random() < 0.5:
        count = draw.choice((0, 1, 2**31, 2**32 - 1, 4_000_000_000, draw.randrange(100)))
        found[80:84] = struct.pack("<I", count)
    else:
        at = 84 + 4 * draw.randrange((len(found) - 84) // 4)
        value = draw.choice((float("nan"), float("inf"), 1e38, -1e30, 1e5, 0.0))
        found[at : at + 4] = struct.pack("<f", value)
    return bytes(found)


def mutate_onnx(draw: random.Random, whole: bytes) -> bytes:
    """Return a model with another shape, operator, weight, place of weights or description."""
    import onnx

    model = onnx.load_model_from_string(whole)
    graph = model.graph
    for _ in range(draw.choice((1, 1, 2, 4))):
        tensor = draw.choice(graph.initializer)
        node = draw.choice(graph.node)
        match draw.randrange(10):
            case 0:
                tensor.data_location = onnx.TensorProto.EXTERNAL
                entry = tensor.external_data.add()
                entry.key, entry.value = "location", draw.choice(("/etc/passwd", "../../x", "a"))
            case 1 if tensor.dims:
                tensor.dims[draw.randrange(len(tensor.dims))] = draw.choice((-1, 0, 1, 2**40, 77))
            case 2:
                names = "Loop If Scan ConstantOfShape Expand Tile Relu Nope MatMul Range Reshape"
                node.op_type = draw.choice(names.split())
            case 3:
                tensor.data_type = draw.randrange(0, 24)
            case 4:
                tensor.raw_data = draw.choice((b"", b"1", tensor.raw_data * 2))
            case 5 if node.input:
                node.input[draw.randrange(len(node.input))] = draw.choice(("", "x", node.output[0]))
            case 6:
                entry = draw.choice(model.metadata_props)
                if entry.value[:1] in "[{1":
                    changed = mutate_value(draw, json.loads(entry.value))
                    entry.value = json.dumps(changed)
                else:
                    entry.value = draw.choice(("", "{", "[]", "null", "9" * 5000))
            case 7:
                model.opset_import[0].version = draw.choice((-1, 0, 1, 17, 9999))
                model.opset_import[0].domain = draw.choice(("", "", "ai.onnx.ml", "x"))
            case 8:
                model.ir_version = draw.choice((-1, 0, 3, 8, 99))
            case _:
                graph.node.append(copy.deepcopy(node))
    return model.SerializeToString()


def _places(value: Any) -> list[tuple[Any, Any]]:
    found, waiting = [], [value]
    while waiting:
        each = waiting.pop()
        inner = (
            list(each.items())
            if isinstance(each, dict)
            else list(enumerate(each))
            if isinstance(each, list)
            else []
        )
        # Of long lists a few: else every mutation hits a number among thousands.
        for key, part in inner[:6] + inner[-2:] if len(inner) > 20 else inner:
            found.append((each, key))
            waiting.append(part)
    return found


def _holds(parent: Any, key: Any) -> bool:
    return key in parent if isinstance(parent, dict) else key < len(parent)


def _nested(depth: int) -> Any:
    value: Any = 1
    for level in range(depth):
        value = [value] if level % 2 else {"a": value}
    return value


def _mutate_array(draw: random.Random, array: np.ndarray) -> np.ndarray:
    if array.dtype.kind == "U" and array.ndim == 0 and draw.random() < 0.8:
        try:
            text = mutate_json(draw, str(array).encode())
        except ValueError:
            text = mutate_bytes(draw, str(array).encode())
        return np.array(text.decode(errors="replace"))
    if array.dtype == np.uint8 and bytes(array[:1]) == b"{" and draw.random() < 0.8:
        return np.frombuffer(mutate_json(draw, array.tobytes()), np.uint8)
    kinds = ("f2", "f8", "i1", "i8", "u8", "?", "c8", "U3", "S2", ">f4", "M8[s]", "O", "i4,f4")
    with np.errstate(all="ignore"):
        match draw.randrange(8):
            case 0:
                try:
                    return array.astype(draw.choice(kinds))
                except (TypeError, ValueError):
                    return array
            case 1:
                return array.reshape(-1)
            case 2:
                return array[None]
            case 3:
                return array[:0] if array.ndim else array
            case 4:
                return np.repeat(array, 2, axis=0) if array.ndim else array.reshape(1)
            case 5 if array.dtype.kind in "fiu" and array.size:
                changed = array.copy()
                numbers = (np.nan, np.inf, -1, 1e30, 0, 2, 1e6)
                small = (0, 1, 127) if array.dtype.kind == "u" else (-1, 0, 1, 127)
                strange = numbers if array.dtype.kind == "f" else small
                changed.reshape(-1)[draw.randrange(array.size)] = draw.choice(strange)
                return changed
            case 6:
                return np.asfortranarray(array)
            case _:
                return np.array(draw.choice((0.0, "x", True, [], [[1, 2], [3, 4]])))


def _mutate_header(draw: random.Random, content: bytes) -> bytes:
    length = int.from_bytes(content[8:10], "little")
    header = content[10 : 10 + length].decode("latin1")
    lie = draw.choice(
        (
            "{'descr': '<f4', 'fortran_order': False, 'shape': (4000000000, 1000000), }",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (-5,), }",
            "{'descr': '|O', 'fortran_order': False, 'shape': (1,), }",
            "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3,), }",
            "{'descr': '<U1000000000', 'fortran_order': False, 'shape': (0,), }",
            "{'descr': '<f4', 'fortran_order': 1, 'shape': (), }",
            "__import__('os').system('touch /tmp/owned')",
            "[" * 4000,
            "{'descr': '|V0', 'fortran_order': False, 'shape': (9,), }",
            header.replace("(", "(1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, "),
            header.replace("False", "True"),
        )
    ).encode("latin1")
    lie = lie.rstrip() + b" " * (-(len(lie.rstrip()) + 11) % 64) + b"\n"
    return content[:8] + len(lie).to_bytes(2, "little") + lie + content[10 + length :]
