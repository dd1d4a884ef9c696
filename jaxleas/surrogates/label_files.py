"""Label folders that `jaxleas label` wrote, read with their guide paths and scenes.

The files are the interface: this room reads them and never calls a planner.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.guide import read_guide_paths
from jaxleas.surrogates.labelled_paths import LabelledPaths, join, label_paths
from jaxleas.surrogates.verdict_files import (
    Finder,
    is_same_planning,
    read_verdict_file,
    require_paths,
    robot_of,
)
from jaxleas.terrain import Atlas, load_scene, make_atlas, rasterise
from jaxleas.types import InputError

MOST_KEPT = 64


@dataclass(frozen=True)
class Labels:
    """The contents of label folders.

    Attributes:
        planner: name of the planner that judged.
        parameters: parameters of the planner.
        robot: name of the robot whose contacts were planned.
        robot_digest: SHA-256 of that robot's file; None where the labels do not say.
        paths: labelled paths.
        atlas: terrains of the paths.
        passed_over: number of guide paths without a verdict, because the planner's time limit came
            first.
    """

    planner: str
    parameters: dict[str, Any]
    robot: str
    robot_digest: str | None
    paths: LabelledPaths
    atlas: Atlas
    passed_over: int


def read_labels(
    folders: Sequence[Path], where: Sequence[Path], resolution: float, most_kept: int = MOST_KEPT
) -> Labels:
    """Read label folders; each file is checked against the fingerprint its verdicts came from.

    Args:
        folders: label folders that `jaxleas label` wrote.
        where: additional folders with guide path and scene files; the label folders and their
            parents are always searched.
        resolution: resolution of the height maps made from the scenes [m].
        most_kept: maximum number of kept configurations of a guide path; longer ones are cut.

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
    finder = Finder(places)
    contents = [read_verdict_file(path) for path in files]
    first = contents[0]["provenance"]
    for path, content in zip(files, contents, strict=True):
        if not is_same_planning(content["provenance"], first):
            raise InputError(
                f"{path} holds verdicts of another planner or other parameters, or on another"
                f" robot, than {files[0]}: one surrogate stands in for one planner"
            )
    keep_every = int(first["parameters"]["keep_every"])
    scenes: dict[str, int] = {}
    maps, parts, passed_over = [], [], 0
    for path, content in zip(files, contents, strict=True):
        provenance = content["provenance"]
        scene = finder.find(provenance["scene"])
        if provenance["scene"]["sha256"] not in scenes:
            scenes[provenance["scene"]["sha256"]] = len(maps)
            maps.append(rasterise(load_scene(scene), resolution))
        paths = read_guide_paths(finder.find(provenance["guides"])).paths
        require_paths(content, paths, path)
        verdicts = [each for each in content["verdicts"] if each.get("decided", True)]
        passed_over += len(content["verdicts"]) - len(verdicts)
        if not verdicts:
            continue
        chosen = [paths[each["path"]] for each in verdicts]
        parts.append(
            label_paths(
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
        robot=robot_of(first)[0],
        robot_digest=next(
            filter(None, (robot_of(each["provenance"])[1] for each in contents)), None
        ),
        paths=join(parts).trimmed(),
        atlas=make_atlas(maps),
        passed_over=passed_over,
    )
