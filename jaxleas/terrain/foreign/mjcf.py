"""MJCF models as triangles, by MuJoCo: what does not move of a scene."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.terrain.foreign.answers import Answer, RefusedError
from jaxleas.terrain.foreign.mjcf_text import standing_part
from jaxleas.terrain.meshes.solids import box_triangles, cylinder_triangles, placed, round_triangles

MAX_TRIANGLES = 5_000_000
WIDE = 5.0
"""Half width of an endless plane that is alone [m]."""
AROUND = 1.0
"""Width of an endless plane around all else [m]."""


def load() -> None:
    """Load the library."""
    import mujoco  # noqa: F401


def read(path: Path, options: dict[str, Any]) -> Answer:
    """Return the `triangles` of the geoms that stand still and touch, in metres."""
    import mujoco as library

    del options
    mujoco: Any = library  # its stubs lack what is made in C
    part = standing_part(path)
    try:
        model = mujoco.MjModel.from_xml_string(part.text, part.assets)
    except ValueError as error:
        raise RefusedError(f"is no model that MuJoCo reads: {str(error)[:200]}") from error
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    shapes: list[np.ndarray] = []
    endless: list[tuple[np.ndarray, np.ndarray]] = []
    passed = Counter[str]()
    for geom in range(model.ngeom):
        kind = mujoco.mjtGeom(int(model.geom_type[geom]))
        turn, at = data.geom_xmat[geom].reshape(3, 3), data.geom_xpos[geom]
        if not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            passed["touches nothing"] += 1
            continue
        if kind == mujoco.mjtGeom.mjGEOM_PLANE and not model.geom_size[geom, :2].all():
            endless.append((turn, at))
            continue
        shape = _shape(model, geom, kind.name)
        if shape is None:
            passed[kind.name] += 1
        else:
            shapes.append(placed(shape, turn, at))
    for turn, at in endless:
        shapes.append(_wide_plane(shapes, turn, at))
    if not shapes:
        raise RefusedError("has nothing that stands still and touches: no terrain")
    triangles = np.concatenate(shapes)
    if len(triangles) > MAX_TRIANGLES:
        raise RefusedError(f"has {len(triangles)} triangles, more than {MAX_TRIANGLES}")
    notes = [*part.notes, *_said(passed, len(endless))]
    return Answer({"triangles": triangles}, notes)


def _shape(model: Any, geom: int, kind: str) -> np.ndarray | None:
    size = np.array(model.geom_size[geom])
    match kind:
        case "mjGEOM_PLANE":
            x, y = size[:2]
            corners = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
            return corners[[[0, 1, 2], [0, 2, 3]]]
        case "mjGEOM_BOX":
            return box_triangles(size)
        case "mjGEOM_CYLINDER":
            return cylinder_triangles(size[0], size[1])
        case "mjGEOM_SPHERE":
            return round_triangles(np.full(3, size[0]))
        case "mjGEOM_ELLIPSOID":
            return round_triangles(size)
        case "mjGEOM_CAPSULE":
            return round_triangles(np.full(3, size[0]), size[1])
        case "mjGEOM_MESH":
            mesh = int(model.geom_dataid[geom])
            first, many = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            start, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
            points = np.array(model.mesh_vert[first : first + many], np.float64)
            return points[model.mesh_face[start : start + count]]
        case "mjGEOM_HFIELD":
            return _field(model, int(model.geom_dataid[geom]))
    return None


def _field(model: Any, field: int) -> np.ndarray:
    """Return the upper face of a height field."""
    rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    start = int(model.hfield_adr[field])
    x_half, y_half, high = model.hfield_size[field, :3]
    z = high * np.array(model.hfield_data[start : start + rows * columns], np.float64)
    y, x = np.meshgrid(
        np.linspace(-y_half, y_half, rows), np.linspace(-x_half, x_half, columns), indexing="ij"
    )
    points = np.column_stack([x.ravel(), y.ravel(), z])
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = [np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)]
    return points[np.concatenate([face.reshape(-1, 3) for face in faces])]


def _wide_plane(shapes: list[np.ndarray], turn: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return an endless plane as far as everything else reaches, and somewhat further."""
    low, high = np.full(2, -WIDE), np.full(2, WIDE)
    if shapes:
        inside = (np.concatenate(shapes) - at) @ turn  # in the plane's frame
        low, high = inside.min(axis=(0, 1))[:2] - AROUND, inside.max(axis=(0, 1))[:2] + AROUND
    corners = np.array(
        [[x, y, 0.0] for x, y in ((low[0], low[1]), (high[0], low[1]), high, (low[0], high[1]))]
    )
    return placed(corners[[[0, 1, 2], [0, 2, 3]]], turn, at)


def _said(passed: "Counter[str]", endless: int) -> list[str]:
    notes = []
    if endless:
        notes.append(
            f"has an endless plane: it ends {AROUND:g} m around all else, or {WIDE:g} m from its"
            " middle"
        )
    if passed["touches nothing"]:
        notes.append(f"has {passed.pop('touches nothing')} geoms that touch nothing: left out")
    if passed:
        kinds = ", ".join(
            f"{count} {kind.removeprefix('mjGEOM_')}" for kind, count in passed.items()
        )
        notes.append(f"has geoms that are left out: {kinds}")
    return notes
