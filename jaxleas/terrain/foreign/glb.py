"""GLB and glTF files as triangles, by trimesh."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.terrain.foreign.answers import Answer, RefusedError

MAX_TRIANGLES = 5_000_000


def load() -> None:
    """Load the library."""
    import trimesh  # noqa: F401


def read(path: Path, options: dict[str, Any]) -> Answer:
    """Return the `triangles` of all meshes of a file, placed as its nodes say, in its units.

    Materials and pictures are not looked for. glTF is y up; whoever writes meshes that are z up
    without turning them is answered in `flat_area`: by x, y and z, the area that looks along it.
    """
    import trimesh

    del options
    with path.open("rb") as stream:
        scene = trimesh.load_scene(stream, file_type="glb", skip_materials=True)
    found = scene.to_geometry() if hasattr(scene, "to_geometry") else scene.dump(concatenate=True)
    triangles = np.asarray(getattr(found, "triangles", np.zeros((0, 3, 3))), np.float64)
    if len(triangles) > MAX_TRIANGLES:
        raise RefusedError(f"has {len(triangles)} triangles, more than {MAX_TRIANGLES}")
    edges = triangles[:, 1:] - triangles[:, :1]
    area = 0.5 * np.abs(np.cross(edges[:, 0], edges[:, 1])).sum(axis=0)
    return Answer({"triangles": triangles, "flat_area": area})
