"""The function behind `jaxleas gait track`."""

import sys
from dataclasses import asdict
from pathlib import Path

from jaxleas.controllers import TICK, PhaseTracker, TrackerSettings, Walk
from jaxleas.crossing.followed_plan import Tracking
from jaxleas.crossing.plan_start import start_of
from jaxleas.crossing.shown_walk import ShownWalk
from jaxleas.crossing.terrain_files import scene_of
from jaxleas.crossing.tracking import track as follow
from jaxleas.crossing.tracking_in_words import NotFollowedError, tracking_in_words
from jaxleas.crossing.walk_log import (
    WalkDescription,
    WalkLogger,
    footstep_arrays,
    write_walk_log,
)
from jaxleas.gaits import eased, quickened, read_gait_plan, track_of
from jaxleas.physics import DEFAULT_BODY, load_body, make_physics
from jaxleas.runs import Progress, collect_provenance
from jaxleas.terrain import READING, Reading, import_terrain, with_cells
from jaxleas.types import InputError

CELL = 0.02
"""Edge of a cell of polygons where none is stated [m]."""
SPARE = 10.0
"""Time beyond the plan's that a robot gets where no limit is stated [s]."""


def track(
    plan: Path,
    *,
    terrain: Path,
    speed: float = 1.0,
    seconds: float | None = None,
    robot: str = DEFAULT_BODY,
    log: Path | None = None,
    reading: Reading = READING,
) -> Tracking:
    """Follow a gait plan in physics, with a quadruped that stands on its first phase's feet.

    It ends with the plan, with a fall, or when its time is over; Ctrl-C ends it, too. What was
    logged is kept. Where the plan is not followed to its end the exit code is 1.

    Args:
        plan: plan, as jaxleas gait plan writes it (.json).
        terrain: scene or mesh, or a map whose surfaces are found; docs/files.md lists all kinds.
        speed: most times as fast as planned, where the programs of the plan allow it.
        seconds: time after which it ends [s]; by default 10 s more than the plan takes.
        robot: robot that walks, or its MJCF file (.xml).
        log: file for state and torques at every physics step (.npz).
        reading: what the terrain file does not state itself.
    """
    if log is not None and log.suffix != ".npz":
        raise InputError(f"{log}: the name of a log must end in .npz")
    if not speed >= 1.0:
        raise InputError(f"--speed {speed:g}: give 1, as planned, or more")
    if seconds is not None and not seconds > 0.0:
        raise InputError(f"--seconds {seconds:g}: give more than 0")
    found, body, settings = read_gait_plan(plan), load_body(robot), TrackerSettings()
    scene = scene_of(terrain, reading)
    heights = import_terrain(terrain, with_cells(terrain, reading, CELL)).height_at
    tracks = track_of(
        quickened(eased(found), speed), heights, (body.foot_radius, settings.clearance)
    )
    start = start_of(found, tracks, body, scene, str(plan))
    walk = Walk(make_physics(body, 1, scene), PhaseTracker(body, tracks, settings))
    logger = WalkLogger(walk)
    limit = seconds or float(tracks.ends[0]) + SPARE
    with Progress(round((float(tracks.ends[0]) + settings.settles) / TICK)) as progress:
        (made,) = follow(walk, start, limit, ShownWalk(progress, logger))
    if made.outcome == "followed":
        print(tracking_in_words(made, tracks))
    if log is not None:
        chosen = {"plan": str(plan), "terrain": str(terrain), "speed": speed}
        outcome = {"outcome": made.outcome, "time": made.time, "cause": made.cause}
        outcome |= {"support": made.support, "fts": made.fts, "fter": made.fter}
        description = WalkDescription(
            *(walk.controller.identity, body.time_step, round(TICK / body.time_step), outcome),
            *(chosen | {"settings": asdict(settings)}, collect_provenance(sys.argv)[0]),
        )
        write_walk_log(log, logger.made(footstep_arrays(()), description))
        print(f"log written to {log}")
    if made.outcome != "followed":
        raise NotFollowedError(made, tracks)
    return made
