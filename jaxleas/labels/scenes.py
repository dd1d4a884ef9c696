"""The scene file that workers read: the user's own, or the one made of it."""

from pathlib import Path

import numpy as np

from jaxleas.terrain import (
    READING,
    PlaneSearch,
    Reading,
    Scene,
    is_map,
    read_scene,
    write_scene,
)
from jaxleas.types import InputError

NAME = "scene.json"
_ROUNDED = 2e-6  # coordinates in files are rounded to a micrometre [m]


def states_itself(scene: Path, reading: Reading, search: PlaneSearch) -> bool:
    """Return whether workers read the same polygons from a terrain file by themselves.

    Args:
        scene: scene, mesh or map that guide paths cross.
        reading: what the file does not state itself.
        search: what counts as a surface in a map.
    """
    return not is_map(scene) and reading == READING and not search.given


def settled_scene(found: Scene, scene: Path, out: Path) -> Path:
    """Return a file of polygons in the folder of the verdicts.

    The surfaces of a map, and a terrain that is moved, cropped or scaled, are written there, where
    workers find them, and whatever reads the verdicts later.

    Args:
        found: polygons of the terrain.
        scene: file that they were read from, for messages.
        out: folder of the verdicts.

    Raises:
        InputError: the folder cannot be made, or holds another scene.
    """
    path = out / NAME
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
