"""The scene file that workers read: the user's own, or the one made of it."""

from pathlib import Path

import numpy as np

from jaxleas.terrain import (
    READING,
    PlaneSearch,
    Reading,
    Scene,
    is_map,
    load_scene,
    read_scene,
    write_scene,
)
from jaxleas.types import InputError

NAME = "scene.json"
_ROUNDED = 2e-6  # coordinates in files are rounded to a micrometre [m]


def settled_scene(scene: Path, out: Path, reading: Reading, search: PlaneSearch) -> Path:
    """Return a file of polygons that states everything itself.

    The surfaces of a map, and a terrain that is moved, cropped or scaled, are written to the folder
    of the verdicts, where workers find them, and whatever reads the verdicts later.

    Args:
        scene: scene, mesh or map that guide paths cross.
        out: folder of the verdicts.
        reading: what the file does not state itself.
        search: what counts as a surface in a map.

    Raises:
        InputError: the file cannot be used, or the folder holds another scene.
    """
    if not is_map(scene) and reading == READING and not search.given:
        return scene
    found, path = load_scene(scene, reading, search), out / NAME
    if path.exists():
        if not _is_same(read_scene(path), found):
            raise InputError(
                f"{path} is another scene than what {scene} gives now; give another --out, or"
                " remove that folder"
            )
        return path
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot make the folder {out}: {error.strerror or error}") from error
    write_scene(path, found)
    return path


def _is_same(one: Scene, other: Scene) -> bool:
    groups = (one.surfaces, other.surfaces), (one.obstacles, other.obstacles)
    return all(
        mine.keys() == theirs.keys()
        and all(
            each.shape == theirs[name].shape and np.abs(each - theirs[name]).max() < _ROUNDED
            for name, each in mine.items()
        )
        for mine, theirs in groups
    )
