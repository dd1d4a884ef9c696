"""The function behind `jaxleas navigate`."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from jaxleas.configuration import Allow
from jaxleas.guide.registry import Method, SteeringName, find_method, require_guardable
from jaxleas.robots import DEFAULT_ROBOT
from jaxleas.terrain import PLANE_SEARCH, READING, PlaneSearch, Reading
from jaxleas.types import InputError

if TYPE_CHECKING:
    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide.roadmaps import Navigation
    from jaxleas.guide.steering_method import SteeringMethod

FARTHEST = 1e6  # largest coordinate of a start or a goal [m]


def navigate(
    *,
    from_: str,
    to: str,
    terrain: Path,
    steering: SteeringName = "leas",
    planner: Literal["rrt", "prm", "none"] = "rrt",
    policy: Path | None = None,
    robot: str | None = None,
    limit: float = 20.0,
    connections: int | None = None,
    seed: int = 0,
    out: Path,
    picture: Path | None = None,
    guard: bool | None = None,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
    allow: Allow = (),
) -> None:
    """Find a guide path between two places on any terrain, through waypoints where needed.

    Args:
        from_: start as x,y or x,y,yaw [m, rad]; without yaw the robot faces the goal if it can.
        to: goal as x,y [m].
        terrain: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        steering: steering method: leas is the policy; kino, RB-Kino, and lin, RB-Lin, know no
            terrain.
        planner: rrt or prm search for waypoints if the direct walk to the goal fails; none = the
            direct walk only.
        policy: run folder, policy.npz, .onnx file or pretrained:NAME, which leas needs; the other
            methods use its task if it is given.
        robot: robot that walks where no policy is given, by name or as the path of its .json; talos
            by default.
        limit: time after which the best partial path is written [s].
        connections: maximum number of connections that the search may try; by default as many as
            the time allows.
        seed: random seed of the search.
        out: file of the guide path and its waypoints, .npz.
        picture: draw the path and its waypoints from above (.png, .svg, .pdf).
        guard: brake before what R* and C refuse, even where the policy would not; by default as the
            policy's configuration states.
        reading: details that the file does not state itself.
        search: what counts as a surface, if the terrain is a map; the final check is on these.
        allow: conditions of your own under which the policy was trained and shall walk; by default
            it walks under R* and C.

    Raises:
        InputError: the robot cannot stand at the start or at the goal, or an option is unusable.
    """
    from jaxleas.guide.cut_off import require_not_cut_off
    from jaxleas.guide.picture import draw_navigation
    from jaxleas.guide.place_refusal import require_valid
    from jaxleas.guide.roadmaps import Budget, Places
    from jaxleas.guide.roadmaps.exact import (
        check_exactly,
        require_exact_start,
        scene_of,
        surfaces_near,
    )
    from jaxleas.guide.roadmaps.ompl import import_ompl
    from jaxleas.guide.roadmaps.tuning import make_navigator
    from jaxleas.guide.starts import start_motion
    from jaxleas.terrain import import_terrain, is_map, require_picture, require_search_of_map
    from jaxleas.xla import keep_compiled_programs

    start, yaw = _place("--from", from_, may_turn=True)
    goal, _ = _place("--to", to, may_turn=False)
    Budget(limit, connections)  # refused before anything is loaded
    if seed < 0:
        raise InputError(f"--seed {seed} must not be negative")
    if out.suffix != ".npz":
        raise InputError(f"--out {out}: guide paths are written as .npz")
    if picture is not None:
        require_picture(picture)
    if planner != "none":
        import_ompl()
    require_search_of_map(terrain, search)
    keep_compiled_programs()
    named = find_method(steering)
    require_guardable(named, guard)
    env, method = _steering(named, policy, robot, allow, guard)
    ground = import_terrain(terrain, reading)
    places = Places(env, ground)
    motion = start_motion(places, start, goal, yaw)
    require_valid(places, "--to", goal, None)
    require_not_cut_off(places, start, goal)
    scene = scene_of(terrain, reading)
    if scene is not None:
        require_exact_start(places, scene, motion)
    navigator = make_navigator(places, method, named.edges, planner, scene)
    found = navigator.navigate(motion, np.array(goal), Budget(limit, connections), seed)
    surfaces = surfaces_near(ground, found.path, search) if is_map(terrain) else scene
    check = None if surfaces is None else check_exactly(env.robot, surfaces, found.path)
    _write(out, found, env.config.robot)
    if picture is not None:
        draw_navigation(picture, ground, found.path, found.waypoints, goal)
    exactly = "" if check is None else f"; {check}"
    print(_sentence(out, found, goal, exactly, searched=planner != "none"))


def _place(option: str, text: str, may_turn: bool) -> tuple[tuple[float, float], float | None]:
    numbers = []
    for part in text.split(","):
        try:
            numbers.append(float(part))
        except ValueError:
            numbers.append(math.nan)
    wanted = "x,y or x,y,yaw" if may_turn else "x,y"
    if len(numbers) not in ((2, 3) if may_turn else (2,)) or not all(map(math.isfinite, numbers)):
        raise InputError(f"{option} {text!r} is not {wanted}: give finite numbers in metres")
    if max(map(abs, numbers[:2])) >= FARTHEST:
        raise InputError(f"{option} {text!r} is more than 1000 km away: are these metres?")
    if len(numbers) == 3 and abs(numbers[2]) > 2.0 * math.pi:
        raise InputError(f"{option} {text!r}: the yaw is in radians, from -6.28 to 6.28")
    return (numbers[0], numbers[1]), numbers[2] if len(numbers) == 3 else None


def _steering(
    method: Method, policy: Path | None, robot: str | None, allow: Allow, guard: bool | None
) -> "tuple[SteeringEnv, SteeringMethod]":
    from jaxleas.envs.steering import SteeringConfig, SteeringEnv
    from jaxleas.guide.loading import load_policy

    if policy is None:
        if method.needs_policy:
            raise InputError(
                f"--steering {method.name} needs --policy: a run folder, a .npz or an .onnx"
            )
        env = SteeringEnv(SteeringConfig.for_robot(robot or DEFAULT_ROBOT))
        return env, method.make(env, None)
    loaded = load_policy(policy, allow, guard)
    if robot not in (None, loaded.config.robot):
        raise InputError(
            f"--robot {robot}: the policy {policy} is for {loaded.config.robot}; leave --robot out,"
            " or give another policy"
        )
    env = SteeringEnv(loaded.config, allow=allow)
    return env, method.make(env, loaded)


def _write(out: Path, found: "Navigation", robot: str) -> None:
    from jaxleas.guide.files import write_guide_paths

    write_guide_paths(out, [found.path], [found.reason], found.waypoints, robot)


def _sentence(
    out: Path, found: "Navigation", goal: tuple[float, float], exactly: str, searched: bool
) -> str:
    count = len(found.waypoints) - 1
    between = f"{count} waypoint{'' if count == 1 else 's'} on the way" if count else "no waypoints"
    effort = f"{found.connections} connections, {found.seconds:.1f} s"
    if found.reached:
        return (
            f"{out}: reached, {found.path.length:.2f} m in {found.path.time[-1]:.0f} s of walking,"
            f" {between} ({effort}){exactly}"
        )
    left = math.dist(found.path.position[-1, :2], goal)
    what = "was not reached within the limit" if searched else "was not reached by walking to it"
    return (
        f"{out}: the goal {what} ({effort}); the best partial path ends"
        f" {left:.2f} m before it{exactly}"
    )
