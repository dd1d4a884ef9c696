"""Label folders as `jaxleas label` leaves them, read back with their guide paths and scenes.

Files are the border: this room reads them and never asks a planner.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.files import read_json
from jaxleas.guide.files import read_guide_paths
from jaxleas.surrogates.walks import LabelledWalks, join, label_walks
from jaxleas.terrain.atlas import Atlas, make_atlas
from jaxleas.terrain.mesh_scene import load_scene
from jaxleas.terrain.rasterise import rasterise
from jaxleas.types import InputError

MOST_KEPT = 64
VERSION = 2  # of verdict files


@dataclass(frozen=True)
class Labels:
    """What was read of some label folders.

    Attributes:
        planner: that judged.
        parameters: it was given.
        walks: with verdicts.
        atlas: their terrains.
        passed_over: guide paths without a verdict: the planner's time limit came first.
    """

    planner: str
    parameters: dict[str, Any]
    walks: LabelledWalks
    atlas: Atlas
    passed_over: int


def read_labels(
    folders: Sequence[Path], where: Sequence[Path], resolution: float, most_kept: int = MOST_KEPT
) -> Labels:
    """Read label folders; each file is checked against the fingerprint its verdicts came from.

    Args:
        folders: written by `jaxleas label`.
        where: folders in which guide path and scene files are looked for, beside the label
            folders themselves and their parents.
        resolution: of the height maps made of the scenes [m].
        most_kept: kept configurations of a guide path; longer ones are cut.

    Raises:
        InputError: a folder has no verdicts, verdicts are of different planners or parameters, or a
            guide path or scene file is missing or has changed.
    """
    files = [path for each in folders for path in sorted(Path(each).rglob("verdicts_*.json"))]
    if not files:
        raise InputError(
            f"there are no verdicts under {', '.join(map(str, folders))}: jaxleas label writes them"
        )
    places = [*where, *(place for each in folders for place in (Path(each), Path(each).parent))]
    finder = _Finder(places)
    contents = [_read(path) for path in files]
    first = contents[0]["provenance"]
    for path, content in zip(files, contents, strict=True):
        for key in ("planner", "parameters"):
            if content["provenance"][key] != first[key]:
                raise InputError(
                    f"{path} holds verdicts of another planner or other parameters than"
                    f" {files[0]}: one surrogate stands in for one planner"
                )
    keep_every = int(first["parameters"]["keep_every"])
    scenes: dict[str, int] = {}
    maps, parts, passed_over = [], [], 0
    for content in contents:
        provenance = content["provenance"]
        scene = finder.find(provenance["scene"])
        if provenance["scene"]["sha256"] not in scenes:
            scenes[provenance["scene"]["sha256"]] = len(maps)
            maps.append(rasterise(load_scene(scene), resolution))
        paths = read_guide_paths(finder.find(provenance["guides"])).paths
        verdicts = [each for each in content["verdicts"] if each.get("decided", True)]
        passed_over += len(content["verdicts"]) - len(verdicts)
        if not verdicts:
            continue
        chosen = [paths[each["path"]] for each in verdicts]
        parts.append(
            label_walks(
                chosen,
                [each["last_index"] for each in verdicts],
                [scenes[provenance["scene"]["sha256"]]] * len(verdicts),
                keep_every,
                most_kept,
            )
        )
    if not parts:
        raise InputError("no guide path has a verdict: all were cut short by the time limit")
    return Labels(
        planner=first["planner"],
        parameters=first["parameters"],
        walks=join(parts).trimmed(),
        atlas=make_atlas(maps),
        passed_over=passed_over,
    )


def _read(path: Path) -> dict[str, Any]:
    content = read_json(path)
    try:
        if content["version"] != VERSION:
            raise InputError(f"{path} is a verdict file of version {content['version']}, not 1")
        provenance = content["provenance"]
        int(provenance["parameters"]["keep_every"])
        for name in ("scene", "guides"):
            str(provenance[name]["file"]), str(provenance[name]["sha256"])
        for verdict in content["verdicts"]:
            int(verdict["path"]), int(verdict["last_index"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path} is no verdict file: {error!r}") from error
    return content


class _Finder:
    """Finds files by name and fingerprint."""

    def __init__(self, places: Sequence[Path]):
        self.places = places
        self.found: dict[str, Path] = {}

    def find(self, named: dict[str, str]) -> Path:
        """Return the file of that name whose content is what the verdicts were made from."""
        fingerprint, name = named["sha256"], Path(named["file"]).name
        if fingerprint in self.found:
            return self.found[fingerprint]
        changed = None
        for place in self.places:
            path = place / name
            if path.is_file():
                if hashlib.sha256(path.read_bytes()).hexdigest() == fingerprint:
                    self.found[fingerprint] = path
                    return path
                changed = path
        if changed is not None:
            raise InputError(f"{changed} is not the file that was judged: its content has changed")
        raise InputError(
            f"{name}, which was judged, is nowhere in {', '.join(map(str, self.places))}: name its"
            " folder with --where"
        )
