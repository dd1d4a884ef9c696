"""The function behind `jaxleas gait walk`."""

import sys
from dataclasses import asdict
from pathlib import Path

from jaxleas.configuration import Allow
from jaxleas.controllers import (
    DEFAULT_CONTROLLER,
    TICK,
    ControllerName,
    Switching,
    Walk,
    find_controller,
)
from jaxleas.crossing.commanders import BlindCommander, Commander, PlanningCommander
from jaxleas.crossing.course import STOPS
from jaxleas.crossing.crossing import cross
from jaxleas.crossing.ground_start import measured_at_start, standing_on
from jaxleas.crossing.in_turn import InTurn
from jaxleas.crossing.in_words import NotReachedError, in_words
from jaxleas.crossing.seen_map import MapErrors
from jaxleas.crossing.shown_walk import ShownWalk
from jaxleas.crossing.tally import tally
from jaxleas.crossing.terrain_files import scene_of
from jaxleas.crossing.walk_log import (
    WalkDescription,
    WalkLogger,
    footstep_arrays,
    write_walk_log,
)
from jaxleas.crossing.walk_planner import costs_of, model_of, planner_of
from jaxleas.crossing.walk_settings import WalkSettings
from jaxleas.crossing.waypoints import read_waypoints
from jaxleas.footsteps import (
    ProposedPlanner,
    parse_pose,
    require_start,
)
from jaxleas.physics import DEFAULT_BODY, load_body, make_physics
from jaxleas.runs import Progress, collect_provenance
from jaxleas.terrain import (
    READING,
    HeightMap,
    Reading,
    SceneEdges,
    import_terrain,
    with_cells,
)
from jaxleas.types import InputError

CELL = 0.01
"""Edge of a cell of polygons where none is stated [m]."""


def walk(
    *,
    terrain: Path,
    goal: str,
    start: str = "0,0,0",
    controller: ControllerName = DEFAULT_CONTROLLER,
    robot: str = DEFAULT_BODY,
    models: Path | None = None,
    higher: ControllerName | None = None,
    waypoints: Path | None = None,
    blind: float | None = None,
    proposal: str | None = None,
    log: Path | None = None,
    settings: WalkSettings = WalkSettings(),  # noqa: B008  # its fields are options
    errors: MapErrors = MapErrors(),  # noqa: B008
    reading: Reading = READING,
    allow: Allow = (),
) -> None:
    """Walk a quadruped to a goal in physics, with its footsteps planned at each contact.

    It ends at the goal (5 cm and 5 degrees), where no command is safe, with a fall, or when its
    time is over; Ctrl-C ends it, too. What was logged is kept. Where the goal is not reached the
    exit code is 1.

    Args:
        terrain: scene or mesh, or a map whose surfaces are found; docs/files.md lists all kinds.
        goal: pose of the centre of mass to reach: X,Y or X,Y,YAW [m, rad].
        start: pose in which the robot stands at first: X,Y or X,Y,YAW [m, rad].
        controller: controller that walks.
        robot: robot that walks, or its MJCF file (.xml).
        models: motion models of the controller; by default those of the package.
        higher: controller with higher swings, which takes over where the ground ahead needs them;
            its motion models are those of the package.
        waypoints: guide path that leads to the goal, as jaxleas navigate writes it.
        blind: speed, as a share of the largest, at which the robot walks straight to the goal
            without a map.
        proposal: file of a proposal, as jaxleas gait distill writes it, that is asked before the
            planner; 'shipped' for that of the package.
        log: file for state and torques at every physics step (.npz).
        settings: how the robot is walked.
        errors: how the robot's map differs from the terrain.
        reading: what the terrain file does not state itself.
        allow: controller of your own that may be run.
    """
    if log is not None and log.suffix != ".npz":
        raise InputError(f"{log}: the name of a log must end in .npz")
    if proposal is not None and blind is not None:
        raise InputError("--proposal and --blind: a blind walk asks no proposal; give one of them")
    if higher is not None and (proposal is not None or blind is not None):
        raise InputError("--higher chooses a controller by its plans: leave --proposal or --blind")
    body = load_body(robot)
    walker = find_controller(controller, body, (controller, *allow))
    together = walker
    if higher is not None:
        together = Switching([walker, find_controller(higher, body, (higher, *allow))])
    scene = scene_of(terrain, reading)
    goals = [] if waypoints is None else read_waypoints(waypoints)
    goals.append(parse_pose(goal, "--goal", STOPS))
    place = parse_pose(start, "--start")
    stands = standing_on(scene, body, [(place.x, place.y, place.yaw)])
    physics = Walk(make_physics(body, 1, scene), together)
    proposed: ProposedPlanner | None = None
    if blind is None:
        height_map = errors.of(_map_of(terrain, reading))
        model = model_of(models, walker)
        costs = costs_of(model, height_map, goals, settings)
        require_start(measured_at_start(physics, stands), costs, walker.identity)
        planner = planner_of(proposal, model, costs, settings)
        proposed = planner if isinstance(planner, ProposedPlanner) else None
        if isinstance(together, Switching):
            given = [model, *(model_of(None, each) for each in together.controllers[1:])]
            turns = InTurn(together.controllers, given, height_map, goals, settings, body)
            planner = turns.planner()
        commander: Commander = PlanningCommander(planner, goals)
    else:
        commander = BlindCommander(walker.identity, goals, blind)
    logger = WalkLogger(physics)
    with Progress(round(settings.seconds / TICK)) as progress:
        seen = ShownWalk(progress, logger)
        (crossing,) = cross(physics, stands, [commander], settings.seconds, seen)
    counts = tally(crossing, SceneEdges.of(scene), walker.identity)
    if crossing.outcome == "reached":
        print(in_words(crossing, goals[-1]))
    print(counts.in_words())
    if proposed is not None:
        print(proposed.in_words())
    if log is not None:
        chosen = {
            **{"terrain": str(terrain), "goal": goal, "start": start, "blind": blind},
            **{"proposal": proposal, "higher": higher},
            **{"settings": asdict(settings), "map": asdict(errors)},
        }
        outcome = {"outcome": crossing.outcome, "time": crossing.time, "cause": crossing.cause}
        description = WalkDescription(
            *(together.identity, body.time_step, round(TICK / body.time_step), outcome, chosen),
            provenance=collect_provenance(sys.argv)[0],
        )
        write_walk_log(log, logger.made(footstep_arrays(crossing.footsteps), description))
        print(f"log written to {log}")
    if crossing.outcome != "reached":
        raise NotReachedError(crossing, goals[-1])


def _map_of(terrain: Path, reading: Reading) -> HeightMap:
    return import_terrain(terrain, with_cells(terrain, reading, CELL))
