"""Verdict files and the files that they name: read, checked, and found again."""

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field

from jaxleas.files import is_file, read_json, require_version, typed
from jaxleas.robots import DEFAULT_ROBOT
from jaxleas.types import GuidePath, InputError

VERSION = 2  # of verdict files


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


def is_same_planning(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether verdicts have in common what all must have that a surrogate learns from."""
    (robot, digest), (name, sha256) = robot_of(one), robot_of(other)
    alike = robot == name and (digest == sha256 or None in (digest, sha256))
    return alike and all(one[key] == other[key] for key in ("planner", "parameters"))


def robot_of(provenance: dict[str, Any]) -> tuple[str, str | None]:
    """Return name and file digest of the robot whose contacts were planned.

    Files from before robots were recorded are of Talos, and hold no digest.
    """
    robot = provenance.get("robot", DEFAULT_ROBOT)
    if isinstance(robot, dict):
        return robot["name"], robot["sha256"]
    return robot, None


def read_verdict_file(path: Path) -> dict[str, Any]:
    """Return the content of a verdict file.

    Raises:
        InputError: it is not one, or of another version.
    """
    content = read_json(path)
    if not isinstance(content, dict):
        raise InputError(f"{path} is not a verdict file: it needs an object")
    require_version(content, VERSION, path)
    typed(_VerdictFile, content, f"{path} is not a verdict file")
    return content


def require_paths(content: dict[str, Any], paths: Sequence[GuidePath], path: Path) -> None:
    """Refuse verdicts on guide paths or configurations that do not exist."""
    for each in content["verdicts"]:
        number, last = each["path"], each["last_index"]
        if number >= len(paths) or last >= len(paths[number]):
            raise InputError(
                f"{path} holds a verdict on configuration {last} of guide path {number}, which the"
                " guide path file does not have"
            )


class Finder:
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
