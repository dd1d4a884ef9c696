"""Guide paths over a height map, judged once more on the polygons of the terrain."""

import logging
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jaxleas.conditions import EXACT_TWINS
from jaxleas.guide.failures import Failure
from jaxleas.guide.files import Reason
from jaxleas.guide.roadmaps.exact import scene_of
from jaxleas.guide.roadmaps.walked import until_refused
from jaxleas.robots import Robot
from jaxleas.terrain import Reading, Scene
from jaxleas.types import GuidePath, InputError

_LOG = logging.getLogger("jaxleas")
_Row = tuple[GuidePath, Reason, Failure | None]


@dataclass(frozen=True)
class EndedPaths:
    """Guide paths and how each ended.

    Attributes:
        paths: guide paths.
        reasons: reason why each path ended.
        failures: what is wrong with the last configuration of each invalid path.
    """

    paths: tuple[GuidePath, ...]
    reasons: tuple[Reason, ...]
    failures: tuple[Failure | None, ...]

    def refused(self) -> int:
        """Return the number of paths that end where the exact conditions alone refuse."""
        return sum(each is not None and each.exactly for each in self.failures)

    def mistaken(self) -> int:
        """Return the number of paths that end where the height map alone refuses."""
        return sum(each is not None and each.else_exact is True for each in self.failures)


def reconfirm(
    robot: Robot, scene: Scene, conditions: Collection[str], walked: EndedPaths
) -> EndedPaths:
    """Return paths that end, invalid, where an exact condition refuses what the map allowed.

    A path that the height map refuses stays invalid, whatever the polygons say of the place.

    Args:
        robot: robot that walks.
        scene: polygons of the terrain.
        conditions: names of the conditions that judged on the map; those of R, R* and C have twins.
        walked: paths over the terrain's height map.
    """
    position = np.concatenate([path.position for path in walked.paths])
    yaw = np.concatenate([path.yaw for path in walked.paths])
    ends = np.cumsum([len(path) for path in walked.paths])[:-1]
    refused = {
        name: np.split(~holds(robot, scene, position, yaw), ends)
        for name, holds in EXACT_TWINS.items()
        if name in conditions
    }
    judged = [
        _judged(row, {name: each[number] for name, each in refused.items()})
        for number, row in enumerate(
            zip(walked.paths, walked.reasons, walked.failures, strict=True)
        )
    ]
    return EndedPaths(*(tuple(column) for column in zip(*judged, strict=True)))


def _judged(row: _Row, refused: Mapping[str, np.ndarray]) -> _Row:
    """Return a path, why it ended and what is wrong there, judged on the polygons as well."""
    path, reason, failure = row
    anyhow = np.logical_or.reduce([np.zeros(len(path), bool), *refused.values()])
    alone = anyhow & path.valid
    if alone.any():
        first = int(np.argmax(alone))
        name = next(name for name, each in refused.items() if each[first])
        return until_refused(path, alone), "invalid", Failure(name, None, exactly=True)
    if failure is not None and refused:
        failure = replace(failure, else_exact=not anyhow[-1])
    return path, reason, failure


def polygons_of(terrain: Path, reading: Reading, wanted: bool | None) -> Scene | None:
    """Return the polygons on which paths are judged once more; None where they are not.

    Args:
        terrain: terrain file.
        reading: what the file does not state itself.
        wanted: whether a person asked for it or against it; None: wherever it is possible.

    Raises:
        InputError: it was asked for, and the polygons cannot be read.
    """
    if wanted is False:
        return None
    try:
        scene = scene_of(terrain, reading)
    except InputError as error:
        if wanted:
            raise
        _LOG.warning("paths are judged on the height map alone: %s", error)
        return None
    if scene is None and wanted:
        _LOG.warning("%s has no polygons: no exact check is possible", terrain)
    return scene
