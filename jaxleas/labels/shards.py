"""Verdict files: one for each few dozen guide paths, complete or absent, so that work resumes."""

import hashlib
import inspect
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from jaxleas.contacts import PLANNERS, PlannerSettings, find_planner
from jaxleas.files import read_json, require_version, write_json
from jaxleas.labels.verdict import verdict_from_json, verdict_to_json
from jaxleas.robots import DEFAULT_ROBOT, robot_digest
from jaxleas.types import InputError, Verdict

VERSION = 2


@dataclass(frozen=True)
class Asked:
    """The question about all guide paths of one file.

    Attributes:
        guides: guide path file.
        scene: scene file.
        planner: name of the planner.
        settings: settings of the planner.
        robot: name of the robot.
    """

    guides: Path
    scene: Path
    planner: str
    settings: PlannerSettings
    robot: str

    def provenance(self) -> dict[str, Any]:
        """Return the provenance of verdicts, as written into their files."""
        own = {} if self.planner in PLANNERS else {"source": _source(self.planner)}
        return {
            "planner": self.planner,
            **own,
            "jaxleas": version("jaxleas"),
            "robot": {"name": self.robot, "sha256": robot_digest(self.robot)},
            "parameters": self.settings.model_dump(mode="json"),
            "seed": getattr(self.settings, "seed", None),
            "scene": {"file": self.scene.name, "sha256": _sha256(self.scene)},
            "guides": {"file": self.guides.name, "sha256": _sha256(self.guides)},
        }


@dataclass(frozen=True)
class Shard:
    """A run of guide paths of one file, judged together.

    Attributes:
        asked: question that is put about them.
        first: number of the first guide path.
        last: number after the last guide path.
        out: verdict file.
        provenance: provenance of the verdicts.
    """

    asked: Asked
    first: int
    last: int
    out: Path
    provenance: dict[str, Any]

    def __len__(self) -> int:
        """Return the number of guide paths."""
        return self.last - self.first

    @property
    def is_done(self) -> bool:
        """Whether the verdict file exists.

        Raises:
            InputError: it exists, but was made from other guides, another scene or other settings.
        """
        if not self.out.exists():
            return False
        content = read_json(self.out)
        if isinstance(content, dict):
            require_version(content, VERSION, self.out)
        found = content.get("provenance") if isinstance(content, dict) else None
        if isinstance(found, dict) and self.asked.robot == DEFAULT_ROBOT:
            found = {"robot": self.provenance["robot"], **found}  # older files name no robot: Talos
        if found != self.provenance:
            raise InputError(
                f"{self.out} holds verdicts made {_difference(found, self.provenance)}; give "
                "another --out, or remove that folder"
            )
        return True


def write_shard(shard: Shard, verdicts: list[Verdict]) -> None:
    """Write verdicts and their provenance, whole or not at all."""
    write_json(
        shard.out,
        {
            "version": VERSION,
            "provenance": shard.provenance,
            "verdicts": [verdict_to_json(verdict) for verdict in verdicts],
        },
    )


def read_verdicts(folder: str | Path) -> list[tuple[dict[str, Any], Verdict]]:
    """Return all verdicts under a folder, each with its provenance, in order of file and path.

    Raises:
        InputError: there are no verdicts, or a file is not a verdict file.
    """
    files = sorted(Path(folder).rglob("verdicts_*.json"))
    if not files:
        raise InputError(f"{folder} holds no verdicts: no file verdicts_*.json is under it")
    found = []
    for path in files:
        content = read_json(path)
        provenance, verdicts = _parts(path, content)
        found += [(provenance, verdict_from_json(value, str(path))) for value in verdicts]
    return found


def _parts(path: Path, content: Any) -> tuple[dict[str, Any], list[Any]]:
    if not isinstance(content, dict) or not {"provenance", "verdicts"} <= content.keys():
        raise InputError(f"{path} is no verdict file: it needs version, provenance and verdicts")
    require_version(content, VERSION, path)
    provenance, verdicts = content["provenance"], content["verdicts"]
    if not isinstance(provenance, dict) or not isinstance(verdicts, list):
        raise InputError(f"{path} is no verdict file: it needs an object and a list of verdicts")
    return provenance, verdicts


def _source(planner: str) -> dict[str, Any]:
    """Return name and SHA-256 of the file that defines a planner of the user's own."""
    file = Path(inspect.getfile(find_planner(planner, [planner]).source))
    return {"file": file.name, "sha256": _sha256(file)}


def _sha256(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror or error}") from error


def _difference(found: Any, wanted: dict[str, Any]) -> str:
    if not isinstance(found, dict):
        return "by something else"
    other = [key for key in wanted if found.get(key) != wanted[key]]
    return f"with other {' and '.join(other)}" if other else "by something else"
