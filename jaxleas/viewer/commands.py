"""The function behind `jaxleas view`."""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from jaxleas.configuration import Allow
from jaxleas.controllers import ControllerName
from jaxleas.files import policy_path
from jaxleas.runs import interrupts_deferred
from jaxleas.terrain import PLANE_SEARCH, READING, PlaneSearch, Reading
from jaxleas.types import InputError
from jaxleas.viewer.policy_robots import drive_policies, load_robots
from jaxleas.viewer.refusals import require_drive, require_moving
from jaxleas.viewer.walker_options import WalkerOptions, require_walker

if TYPE_CHECKING:
    from viser import ViserServer

    from jaxleas.robots import Robot
    from jaxleas.terrain import HeightMap
    from jaxleas.viewer.clips import Clip
    from jaxleas.viewer.legged_view import Quadruped
    from jaxleas.viewer.show import Player


def view(
    terrain: Path,
    *,
    policies: Sequence[Path] | None = None,
    controller: ControllerName | None = None,
    start: tuple[float, float, float] | None = None,
    goal: tuple[float, float] | None = None,
    guide: Path | None = None,
    plan: Path | None = None,
    problem: Path | None = None,
    robot: str | None = None,
    models: Path | None = None,
    proposal: str | None = None,
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
        policies: run folders, policy.npz or .onnx files, or pretrained:NAME; one robot each, side
            by side.
        controller: walking controller of a quadruped, whose footsteps are planned while it walks
            in physics to where it is sent.
        start: start of the robots: x, y [m] and heading [deg]; by default a place with room.
        goal: first goal of the robots: x, y [m].
        guide: file of guide paths to play back, .npz.
        plan: file of a contact plan to play back, .json; needs --problem.
        problem: file of the contact problem that the plan solves, .json.
        robot: robot that is played back, by name or as the path of its file; by default that of the
            guide paths or the problem, else talos. Without a playback it is the one that
            --controller walks: anymal_b, or an MJCF file (.xml).
        models: motion models of the controller; by default those of the package.
        proposal: file of a proposal that is asked before the footstep planner; 'shipped' for that
            of the package.
        record: write the walk to --goal, or the playback, as one HTML file, and end.
        host: address to listen on; the default can only be reached from this machine.
        port: port to listen on; 0 for any free port.
        browser: open a browser window, if there is a display.
        surfaces: show the surfaces found in a map of up to 4 million cells, each in a hue of its
            own.
        reading: details that the file does not state itself.
        search: what counts as a surface, if the terrain is a map.
        allow: conditions of your own under which the policies were trained and shall walk; by
            default they walk under R* and C.
    """
    from jaxleas.terrain import import_terrain, is_map, read_scene, require_search_of_map
    from jaxleas.viewer.ground import draw_terrain, look_near, paint_sky
    from jaxleas.viewer.recording import Recorder
    from jaxleas.viewer.server import serving
    from jaxleas.viewer.show import show, write_recording
    from jaxleas.viewer.surfaces import show_surfaces

    if (plan is None) != (problem is None):
        raise InputError("--plan and --problem belong together: a plan names no feet by itself")
    policies = [policy_path(each) for each in policies or ()]
    driven = [str(each) for each in policies] + ([controller] if controller else [])
    require_drive(driven, start, goal)
    require_moving(driven, goal, guide, plan, record)
    for each in policies:  # before the page is shown; their content is read afterwards
        if not each.exists():
            raise InputError(f"--policies: there is no {each}; a run folder, a .npz or an .onnx")
    require_walker(controller, models, proposal)
    clips = _clips(guide, plan, problem, robot)
    if robot is not None and not (clips or controller):
        raise InputError(
            "--robot is played back with --guide or --plan, or walked by --controller; a policy has"
            " its own"
        )
    drawn = _robot_to_draw(clips, robot) if clips else None
    require_search_of_map(terrain, search)
    ground = import_terrain(terrain, reading)
    if drawn is not None and robot is None:
        _warn_of_height(clips, drawn, ground)
    scene = read_scene(terrain) if terrain.suffix.lower() == ".json" else None
    with (
        serving(host, 0 if record else port) as server,
        _until_interrupted(record is None),
        ExitStack() as kept,
    ):
        draw_terrain(server, ground, scene)
        if surfaces and is_map(terrain):
            show_surfaces(server, terrain, ground, search)
        if driven:
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
            robots = load_robots(policies, allow)
            players.append(drive_policies(server, ground, robots, start, goal))
            waiting.remove()
        if controller:
            own = None if clips else robot
            asked = WalkerOptions(controller, start, own, models, proposal)
            made = _walker(server, ground, terrain, reading, asked)
            is_live = record is None
            players.append(kept.enter_context(made.on(server, ground, goal, is_live)))
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


def _walker(
    server: "ViserServer",
    ground: "HeightMap",
    terrain: Path,
    reading: Reading,
    options: WalkerOptions,
) -> "Quadruped":
    """Return a quadruped that stands where it begins, which the page looks at."""
    waiting = server.gui.add_markdown("The quadruped is being made ...")
    with interrupts_deferred():
        from jaxleas.viewer.ground import look_near
        from jaxleas.viewer.legged_view import Quadruped

    made = Quadruped(terrain, reading, options)
    look_near(server, ground, made.place)
    waiting.remove()
    return made
