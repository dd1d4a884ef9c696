"""The function behind `jaxleas view`."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jaxleas.configuration import Allow
from jaxleas.runs import interrupts_deferred
from jaxleas.terrain import PLANE_SEARCH, READING, PlaneSearch, Reading
from jaxleas.types import InputError
from jaxleas.viewer.refusals import require_drive, require_moving

if TYPE_CHECKING:
    from viser import ViserServer

    from jaxleas.envs.steering import SteeringEnv
    from jaxleas.guide import OnnxPolicy
    from jaxleas.robots import Robot
    from jaxleas.terrain import HeightMap
    from jaxleas.training import Policy
    from jaxleas.viewer.clips import Clip
    from jaxleas.viewer.drive import Drive
    from jaxleas.viewer.show import Player

    NamedRobot = tuple[str, SteeringEnv, Policy | OnnxPolicy]


def view(
    terrain: Path,
    *,
    policies: Sequence[Path] | None = None,
    start: tuple[float, float, float] | None = None,
    goal: tuple[float, float] | None = None,
    guide: Path | None = None,
    plan: Path | None = None,
    problem: Path | None = None,
    robot: str | None = None,
    record: Path | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
    browser: bool = True,
    surfaces: bool = True,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
    allow: Allow = (),
) -> None:
    """Show a terrain in the browser; drive policies on it, play back paths and plans.

    Args:
        terrain: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        policies: run folders, policy.npz or .onnx files: one robot each, side by side.
        start: start of the robots: x, y [m] and heading [deg]; by default a place with room.
        goal: first goal of the robots: x, y [m].
        guide: guide paths to play back, .npz.
        plan: a contact plan to play back, .json; with --problem.
        problem: the contact problem that the plan solves, .json.
        robot: name of the robot that is played back, or path of its file; by default the robot that
            the guide paths or the problem name, else talos.
        record: write the walk to --goal, or the playback, as one HTML file, and end.
        host: address to listen on; the default can only be reached from this machine.
        port: port to listen on; 0 for any free port.
        browser: open a browser window, if there is a display.
        surfaces: show the surfaces found in a map, one hue each; of maps up to 4 million cells.
        reading: details that the file does not state itself.
        search: what counts as a surface, if the terrain is a map.
        allow: conditions of your own that the policies were trained under, to walk them under
            these; by default R* and C.
    """
    from jaxleas.terrain import import_terrain, is_map, read_scene, require_search_of_map
    from jaxleas.viewer.ground import draw_terrain, look_near, paint_sky
    from jaxleas.viewer.recording import Recorder
    from jaxleas.viewer.server import serving
    from jaxleas.viewer.show import show, write_recording
    from jaxleas.viewer.surfaces import show_surfaces

    if (plan is None) != (problem is None):
        raise InputError("--plan and --problem belong together: a plan names no feet by itself")
    require_drive(policies, start, goal)
    require_moving(policies, goal, guide, plan, record)
    for each in policies or ():  # before the page is shown; their content is read afterwards
        if not each.exists():
            raise InputError(f"--policies: there is no {each}; a run folder, a .npz or an .onnx")
    clips = _clips(guide, plan, problem, robot)
    if robot is not None and not clips:
        raise InputError("--robot is played back with --guide or --plan; a policy has its own")
    drawn = _robot_to_draw(clips, robot) if clips else None
    require_search_of_map(terrain, search)
    ground = import_terrain(terrain, reading)
    if drawn is not None and robot is None:
        _warn_of_height(clips, drawn, ground)
    scene = read_scene(terrain) if terrain.suffix.lower() == ".json" else None
    with serving(host, 0 if record else port) as server, _until_interrupted(record is None):
        draw_terrain(server, ground, scene)
        if surfaces and is_map(terrain):
            show_surfaces(server, terrain, ground, search)
        if policies:
            look_near(server, ground, None if start is None else start[:2])
        recorder = Recorder(server)
        if record is None:
            _announce(server, browser)
            recorder.add_panel()
            paint_sky(server)
        # JAX is loaded only now, while the browser draws the ground.
        players: list[Player] = []
        if drawn is not None:
            players.append(_play_back(server, drawn, clips, playing=record is not None))
        if policies:
            waiting = server.gui.add_markdown("The policies are being loaded ...")
            robots = _load_robots(policies, allow)
            players.append(_drive(server, ground, robots, start, goal))
            waiting.remove()
        if record is None:
            show(players, recorder)
        else:
            write_recording(record, recorder, players)


@contextmanager
def _until_interrupted(is_the_end: bool) -> Iterator[None]:
    """Take Ctrl-C as the end of a live view, but not of a recording."""
    try:
        yield
    except KeyboardInterrupt:
        if not is_the_end:
            raise
        print()  # end the line on which the terminal shows Ctrl-C


def _clips(
    guide: Path | None, plan: Path | None, problem: Path | None, robot: str | None
) -> "list[Clip]":
    if guide is None and plan is None:
        return []  # do not spend a second on importing their readers
    from jaxleas.viewer.clips import read_guide_clips, read_plan_clip

    clips = read_guide_clips(guide, robot) if guide is not None else []
    if plan is not None and problem is not None:
        clips.append(read_plan_clip(plan, problem))
    return clips


def _announce(server: "ViserServer", browser: bool) -> None:
    from jaxleas.viewer.server import address_of, from_elsewhere, open_browser

    address = address_of(server)
    opened = browser and open_browser(address)
    print(
        f"{address} {'is open in your browser' if opened else 'shows it in any browser'};"
        f" {from_elsewhere(server.get_host(), server.get_port())}; Ctrl-C ends",
        flush=True,
    )


def _robot_to_draw(clips: "list[Clip]", named: str | None) -> "Robot":
    from jaxleas.viewer.playback import robot_to_draw

    return robot_to_draw(clips, named)


def _warn_of_height(clips: "list[Clip]", drawn: "Robot", ground: "HeightMap") -> None:
    from jaxleas.viewer.clips import warn_of_height

    warn_of_height(clips, drawn, ground)


def _play_back(
    server: "ViserServer", robot: "Robot", clips: "list[Clip]", playing: bool
) -> "Player":
    from jaxleas.viewer.playback import Playback

    playback = Playback(server, robot, clips)
    if playing:
        playback.play()
    return playback


def _load_robots(policies: Sequence[Path], allow: Allow) -> "list[NamedRobot]":
    """Return name, environment and policy of each robot."""
    with interrupts_deferred():
        from jaxleas.envs.steering import SteeringEnv
        from jaxleas.guide import load_policy
        from jaxleas.xla import keep_compiled_programs

    keep_compiled_programs()
    loaded = [load_policy(each, allow) for each in policies]
    envs = [SteeringEnv(each.config, allow=allow) for each in loaded]
    return list(zip(_names(policies), envs, loaded, strict=True))


def _drive(
    server: "ViserServer",
    terrain: "HeightMap",
    robots: "list[NamedRobot]",
    start: tuple[float, float, float] | None,
    goal: tuple[float, float] | None,
) -> "Drive":
    with interrupts_deferred():
        from jaxleas.guide import choose_start, require_start
        from jaxleas.terrain import make_atlas
        from jaxleas.viewer.drive import Drive
        from jaxleas.viewer.driven_robot import DrivenRobot
        from jaxleas.viewer.ground import look_near

    first = robots[0][1]
    place = choose_start(first, terrain) if start is None else require_start(first, terrain, start)
    x, y, _ = place.position
    look_near(server, terrain, (float(x), float(y)))
    atlas = make_atlas([terrain])
    driven = [DrivenRobot(name, env, policy, atlas) for name, env, policy in robots]
    drive = Drive(server, terrain, driven, place)
    if goal is not None:
        drive.send(goal)
    return drive


def _names(paths: Sequence[Path]) -> list[str]:
    """Return the names of policies: the run folder, with the file where two are equal."""
    whole = [each.resolve() for each in paths]
    short = [each.parent.name if each.stem == "policy" else each.stem for each in whole]
    return [
        name if short.count(name) == 1 else "/".join(each.parts[-2:])
        for name, each in zip(short, whole, strict=True)
    ]
