"""Mutations of what binary files hold: arrays, ONNX models, pictures, meshes."""

import copy
import io
import json
import random
import struct
import zipfile
import zlib

import numpy as np

from tests.robustness.hostile_files.mutations import mutate_bytes, mutate_json, mutate_value


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
