"""Meshes with computed light: glTF with a colour per vertex and an unlit material.

A browser that draws in software spends most of a frame on light; here the light of an even sky and
a sun is computed once, on the host, and the page only fills triangles.
"""

import json
import struct
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from jaxleas.viewer.terrain_mesh import Mesh

if TYPE_CHECKING:
    from viser import GlbHandle, ViserServer

SUN = np.array([-4.0, -6.0, 9.0]) / np.linalg.norm([-4.0, -6.0, 9.0])
"""Direction to the sun: south-west, where the camera is, and high."""
SKY_LIGHT, SUN_LIGHT = 0.82, 0.5
"""Shares of a face's colour that come from the open sky and from a sun at right angles to it."""
FLOAT, USHORT, UINT = 5126, 5123, 5125  # component types of glTF
VERTICES, INDICES = 34962, 34963  # buffer targets of glTF


def flat(mesh: Mesh) -> Mesh:
    """Return a mesh whose triangles share no corners, so that each can have its own shade."""
    return Mesh(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(mesh.faces.size).reshape(-1, 3))


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes as one."""
    firsts = np.cumsum([0, *(len(each.vertices) for each in meshes[:-1])])
    return Mesh(
        np.concatenate([each.vertices for each in meshes]),
        np.concatenate([each.faces + first for each, first in zip(meshes, firsts, strict=True)]),
    )


def two_sided(mesh: Mesh) -> Mesh:
    """Return a mesh whose faces are also visible from behind."""
    return Mesh(mesh.vertices, np.concatenate([mesh.faces, mesh.faces[:, ::-1]]))


def shade(mesh: Mesh, colours: Float[np.ndarray, "*V 3"]) -> Float[np.ndarray, "V 3"]:
    """Return the colours of a mesh's corners under the light.

    Args:
        mesh: mesh whose faces share corners only where they lie in one plane.
        colours: colour of each corner, or of all, 0 to 255.
    """
    first, second, third = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    normals = np.cross(second - first, third - first)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    upright = np.zeros((len(mesh.vertices), 3))
    upright[mesh.faces] = normals[:, None, :]
    sky = SKY_LIGHT * (0.75 + 0.25 * upright[:, 2:])
    light = sky + SUN_LIGHT * np.maximum(upright @ SUN[:, None], 0.0)
    return np.clip(colours * light, 0.0, 255.0)


def add_painted(
    server: "ViserServer",
    name: str,
    mesh: Mesh,
    colours: Float[np.ndarray, "V 3"],
    opacity: float = 1.0,
) -> "GlbHandle":
    """Add a mesh to the page, replacing one of the same name; the rest is as for `glb_of`."""
    content = glb_of(mesh, colours, opacity)
    return server.scene.add_glb(name, content, cast_shadow=False, receive_shadow=False)


def glb_of(mesh: Mesh, colours: Float[np.ndarray, "V 3"], opacity: float = 1.0) -> bytes:
    """Return a mesh as binary glTF with an unlit material (KHR_materials_unlit).

    Its faces are only visible from the front: all opaque meshes share one program, which a browser
    that draws in software takes 0.2 s to compile.

    Args:
        mesh: mesh to be drawn, z up [m].
        colours: final colour of each corner, sRGB from 0 to 255.
        opacity: opacity of the whole mesh.
    """
    positions = np.asarray(mesh.vertices, "<f4")
    paint = np.column_stack([_linear(colours), np.full(len(positions), 65535.0)])
    chunks = [positions, np.round(paint).astype("<u2"), np.asarray(mesh.faces, "<u4").ravel()]
    starts = np.cumsum([0, *(each.nbytes for each in chunks)])
    material: dict[str, Any] = {
        "extensions": {"KHR_materials_unlit": {}},
        "pbrMetallicRoughness": {"baseColorFactor": [1.0, 1.0, 1.0, opacity]},
    }
    if opacity < 1.0:
        material["alphaMode"] = "BLEND"
    primitive = {"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2, "material": 0}
    targets = (VERTICES, VERTICES, INDICES)
    count = len(positions)
    accessors: list[dict[str, Any]] = [
        {"componentType": FLOAT, "count": count, "type": "VEC3"},
        {"componentType": USHORT, "count": count, "type": "VEC4", "normalized": True},
        {"componentType": UINT, "count": mesh.faces.size, "type": "SCALAR"},
    ]
    if count:
        accessors[0] |= {
            "min": positions.min(axis=0).tolist(),
            "max": positions.max(axis=0).tolist(),
        }
    tree = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}],
        "materials": [material],
        "accessors": [{"bufferView": index, **each} for index, each in enumerate(accessors)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(start), "byteLength": each.nbytes, "target": target}
            for start, each, target in zip(starts, chunks, targets, strict=False)
        ],
        "buffers": [{"byteLength": int(starts[-1])}],
    }
    return _binary(tree, b"".join(each.tobytes() for each in chunks))


def _linear(colours: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "V 3"]:
    """Return sRGB from 0 to 255 as linear light from 0 to 65535."""
    share = np.asarray(colours, np.float64) / 255.0
    return 65535.0 * np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def _binary(tree: dict[str, Any], content: bytes) -> bytes:
    text = json.dumps(tree, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    content += b"\0" * (-len(content) % 4)
    size = 12 + 8 + len(text) + 8 + len(content)
    head = struct.pack("<4sII", b"glTF", 2, size)
    parts = (struct.pack("<I4s", len(text), b"JSON"), text)
    return b"".join((head, *parts, struct.pack("<I4s", len(content), b"BIN\0"), content))
