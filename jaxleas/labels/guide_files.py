"""Guide path files that are to be judged: whose paths they hold, and how these ended."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.contacts import planned_robot
from jaxleas.files import digest_of
from jaxleas.guide import read_guide_paths
from jaxleas.terrain import Scene
from jaxleas.types import Ending, InputError, Verdict


@dataclass(frozen=True)
class GuideFiles:
    """What guide path files say of their paths, apart from any planner.

    Attributes:
        robot: name of the robot that walked all of them.
        notes: lines to print about it.
        endings: how the paths of each file ended, by the file's SHA-256.
    """

    robot: str
    notes: tuple[str, ...]
    endings: Mapping[str, Sequence[Ending]]

    def endings_of(self, found: Iterable[tuple[Mapping[str, Any], Verdict]]) -> list[Ending]:
        """Return how the paths of verdicts ended; unknown for files that are not among these.

        Args:
            found: verdicts, each with its provenance.
        """
        known: dict[tuple[str, int], Ending] = {
            (sha256, path): ending
            for sha256, endings in self.endings.items()
            for path, ending in enumerate(endings)
        }
        return [
            known.get((provenance["guides"]["sha256"], verdict.path), "unknown")
            for provenance, verdict in found
        ]


def read_guide_files(
    guides: Sequence[Path], scene: Callable[[], Scene], robot: str | None
) -> GuideFiles:
    """Read whose paths the files hold, and how these ended.

    Args:
        guides: guide path files.
        scene: function that returns the scene that they cross, called for each file that needs it.
        robot: robot that a person named; None if none was named.

    Raises:
        InputError: a file cannot be used, or its paths are another robot's than the others'.
    """
    robots, endings = [], {}
    for path in guides:
        file = read_guide_paths(path)
        robots.append(planned_robot(file.robot, robot, file.paths, scene, path))
        endings[digest_of(path)] = file.endings
        if robots[-1].name != robots[0].name:
            raise InputError(
                f"{guides[0]} is of {robots[0].name}, and {path} of {robots[-1].name}: label the"
                " paths of each robot into a folder of their own"
            )
    notes = tuple(dict.fromkeys(each.note for each in robots if each.note))
    return GuideFiles(robots[0].name, notes, endings)
