"""Label folders that `jaxleas label` wrote, read with their guide paths and scenes.

The files are the interface: this room reads them and never calls a planner.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field

from jaxleas.files import is_file, read_json, require_version, typed
from jaxleas.guide import read_guide_paths
from jaxleas.robots import DEFAULT_ROBOT
from jaxleas.surrogates.walks import LabelledWalks, join, label_walks
from jaxleas.terrain import Atlas, load_scene, make_atlas, rasterise
from jaxleas.types import GuidePath, InputError

MOST_KEPT = 64
VERSION = 2  # of verdict files


@dataclass(frozen=True)
class Labels:
    """The contents of label folders.

    Attributes:
        planner: name of the planner that judged.
        parameters: parameters of the planner.
        robot: name of the robot whose contacts were planned.
        robot_digest: SHA-256 of that robot's file; None where the labels do not say.
        walks: labelled walks.
        atlas: terrains of the walks.
        passed_over: number of guide paths without a verdict, because the planner's time limit came
            first.
    """

    planner: str
    parameters: dict[str, Any]
    robot: str
    robot_digest: str | None
    walks: LabelledWalks
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
    finder = _Finder(places)
    contents = [_read(path) for path in files]
    first = contents[0]["provenance"]
    for path, content in zip(files, contents, strict=True):
        if not _is_same(content["provenance"], first):
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
        _require_paths(content, paths, path)
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
        robot=_robot(first)[0],
        robot_digest=next(filter(None, (_robot(each["provenance"])[1] for each in contents)), None),
        walks=join(parts).trimmed(),
        atlas=make_atlas(maps),
        passed_over=passed_over,
    )


class _File(BaseModel):
    """The name and fingerprint of a file."""

    file: str
    sha256: str


class _Parameters(BaseModel):
    keep_every: Annotated[int, Field(ge=1, le=100_000)]


class _Robot(BaseModel):
    name: str
    sha256: str


class _Provenance(BaseModel):
    planner: str
    robot: _Robot | str = DEFAULT_ROBOT
    parameters: _Parameters
    scene: _File
    guides: _File


class _Verdict(BaseModel):
    path: Annotated[int, Field(ge=0)]
    last_index: Annotated[int, Field(ge=-1)]
    decided: bool = True


class _VerdictFile(BaseModel):
    provenance: _Provenance
    verdicts: list[_Verdict]


def _is_same(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether verdicts have in common what all must have that a surrogate learns from."""
    (robot, digest), (name, sha256) = _robot(one), _robot(other)
    alike = robot == name and (digest == sha256 or None in (digest, sha256))
    return alike and all(one[key] == other[key] for key in ("planner", "parameters"))


def _robot(provenance: dict[str, Any]) -> tuple[str, str | None]:
    """Return name and file digest of the robot whose contacts were planned.

    Files from before robots were recorded are of Talos, and hold no digest.
    """
    robot = provenance.get("robot", DEFAULT_ROBOT)
    if isinstance(robot, dict):
        return robot["name"], robot["sha256"]
    return robot, None


def _read(path: Path) -> dict[str, Any]:
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a verdict file: it needs an object")
    require_version(content, VERSION, path)
    typed(_VerdictFile, content, f"{path} is not a verdict file")
    return content


def _require_paths(content: dict[str, Any], paths: Sequence[GuidePath], path: Path) -> None:
    """Refuse verdicts on guide paths or configurations that do not exist."""
    for each in content["verdicts"]:
        number, last = each["path"], each["last_index"]
        if number >= len(paths) or last >= len(paths[number]):
            raise InputError(
                f"{path} holds a verdict on configuration {last} of guide path {number}, which the"
                " guide path file does not have"
            )


class _Finder:
    """A search for files by name and fingerprint."""

    def __init__(self, places: Sequence[Path]):
        self.places = places
        self.found: dict[str, Path] = {}

    def find(self, named: dict[str, str]) -> Path:
        """Return the file with the name and content that the verdicts were made from."""
        fingerprint, name = named["sha256"], Path(named["file"]).name  # never out of its folder
        if fingerprint in self.found:
            return self.found[fingerprint]
        changed = None
        for place in self.places:
            path = place / name
            if is_file(path):
                if hashlib.sha256(path.read_bytes()).hexdigest() == fingerprint:
                    self.found[fingerprint] = path
                    return path
                changed = path
        if changed is not None:
            raise InputError(f"{changed} is not the file that was judged: its content has changed")
        raise InputError(
            f"{name:.200}, which was judged, is nowhere in {', '.join(map(str, self.places))}: name"
            " its folder with --where"
        )
