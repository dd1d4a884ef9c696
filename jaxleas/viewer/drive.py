"""Driving: users send robots to goals, or steer them, and the policies walk them there."""

import html
from collections.abc import Callable, Sequence
from importlib import resources
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.terrain import HeightMap
from jaxleas.types import RootPose
from jaxleas.viewer.driven_robot import DrivenRobot
from jaxleas.viewer.rider import Rider
from jaxleas.viewer.robot_shape import ROBOTS, RobotShape, draw_goal
from jaxleas.viewer.terrain_mesh import meet

if TYPE_CHECKING:
    from viser import ViserServer

LEAD = 1.0
"""Distance ahead of a steered robot at which its goal is set, again and again [m]."""
TURN = np.radians(15.0)
"""Angle by which a key press turns the course [rad]."""
SPEAK_EVERY = 8
"""Frames between two drawings of the status, which the page rebuilds."""
WORDS = {
    "waiting": "stands, waiting for a goal",
    "walking": "walks",
    "arrived": "has arrived",
    "invalid": "stands invalid: reset it",
}


class Drive:
    """The panel for driving, and the actions of each frame.

    User actions arrive on the server's threads; they wait in a queue for the next frame, so that
    only one thread moves robots.
    """

    def __init__(
        self,
        server: "ViserServer",
        terrain: HeightMap,
        robots: Sequence[DrivenRobot],
        start: RootPose,
    ) -> None:
        """Draw robots and panel.

        Args:
            server: server of the page.
            terrain: terrain that users click on.
            robots: robots, drawn side by side.
            start: pose where all of them begin.
        """
        self._terrain = terrain
        self._wishes: SimpleQueue[Callable[[], None]] = SimpleQueue()
        self._course: float | None = None
        self._spoken = ("", "")
        self._frames = 0
        self._riders = [
            Rider(driven, self._shape(server, index, driven, len(robots) > 1), start)
            for index, driven in enumerate(robots)
        ]
        self._goal = draw_goal(server, start.position)
        with server.gui.add_folder("Drive"):
            self._add_panel(server)
        server.scene.on_click()(self._clicked)
        self._add_keys(server)

    @property
    def busy(self) -> bool:
        """Whether a robot is still walking."""
        return any(rider.driven.state == "walking" for rider in self._riders)

    def frame(self, seconds: float) -> None:
        """Advance the page.

        Args:
            seconds: time since the previous frame [s].
        """
        while not self._wishes.empty():
            self._wishes.get()()
        for rider in self._riders:
            rider.advance(seconds * self._speed.value, self._steer)
        self._speak()

    def send(self, goal: tuple[float, float]) -> None:
        """Send the robots to a goal (x, y) [m]."""
        self._course = None
        for rider in self._riders:
            rider.driven.seek(goal)
        ground = np.nan_to_num(self._terrain.height_at(np.array([goal]))[0])
        self._goal.position = (goal[0], goal[1], float(ground))
        self._goal.visible = True
        self._goal_x.value, self._goal_y.value = round(goal[0], 2), round(goal[1], 2)

    def reset(self) -> None:
        """Put the robots back at the start."""
        self._course = None
        for rider in self._riders:
            rider.reset()
        self._goal.visible = False

    def stop(self) -> None:
        """Stop the robots."""
        self._course = None
        for rider in self._riders:
            rider.driven.stop()

    def turn(self, angle: float) -> None:
        """Walk on a course turned by an angle [rad]; the first course is the heading."""
        if self._course is None:
            self._course = float(self._riders[0].driven.pose.yaw)
            self._goal.visible = False
        self._course += angle
        for rider in self._riders:
            self._steer(rider.driven)

    def _steer(self, driven: DrivenRobot) -> None:
        if self._course is not None:
            x, y, _ = driven.pose.position
            driven.seek((x + LEAD * np.cos(self._course), y + LEAD * np.sin(self._course)))

    def _shape(
        self, server: "ViserServer", index: int, driven: DrivenRobot, named: bool
    ) -> RobotShape:
        name, robot = f"/robot_{index}", driven.env.robot
        shape = RobotShape(server, name, robot, ROBOTS[index % len(ROBOTS)])
        if named:
            # They begin at one place: each name is above the previous one.
            top = max(box.high[2] for box in robot.trunk) + 0.15 * (index + 1)
            server.scene.add_label(f"{name}/name", driven.name, position=(0.0, 0.0, top))
        return shape

    def _add_panel(self, server: "ViserServer") -> None:
        gui = server.gui
        gui.add_markdown(
            "Click the ground, or steer with **I** ahead, **J** left, **L** right,"
            " **K** stop, or a gamepad."
        )
        x_min, x_max, y_min, y_max = self._terrain.extent
        middle = (0.5 * (x_min + x_max), 0.5 * (y_min + y_max))
        self._goal_x = gui.add_number("Goal x [m]", round(middle[0], 2), step=0.01)
        self._goal_y = gui.add_number("Goal y [m]", round(middle[1], 2), step=0.01)
        self._button(gui, "Go", lambda: self.send((self._goal_x.value, self._goal_y.value)))
        self._button(gui, "Stop", self.stop)
        self._button(gui, "Back to the start", self.reset)
        self._speed = gui.add_slider("Times real speed", 0.5, 20.0, 0.5, 4.0)
        reach = gui.add_checkbox("Reach of the legs", True)
        seen = gui.add_checkbox("What the policy sees", True)
        self._status = gui.add_html("")

        @reach.on_update
        def _(_: Any) -> None:
            for rider in self._riders:
                for mesh in rider.shape.reach:
                    mesh.visible = reach.value

        @seen.on_update
        def _(_: Any) -> None:
            for rider in self._riders:
                rider.shape.show_points(seen.value)

    def _button(self, gui: Any, label: str, act: Callable[[], None]) -> None:
        gui.add_button(label).on_click(lambda _: self._wishes.put(act))

    def _add_keys(self, server: "ViserServer") -> None:
        keys: list[tuple[Any, str, Callable[[], None]]] = [
            ("I", "Walk ahead", lambda: self.turn(0.0)),
            ("J", "Turn left", lambda: self.turn(TURN)),
            ("L", "Turn right", lambda: self.turn(-TURN)),
            ("K", "Stop", self.stop),
        ]
        for key, label, act in keys:
            command = server.gui.add_command(label, hotkey=key)
            command.on_trigger(lambda _, act=act: self._wishes.put(act))
        script = resources.files("jaxleas.viewer").joinpath("gamepad.html").read_text("utf-8")
        server.gui.add_html(f'<iframe hidden srcdoc="{html.escape(script)}"></iframe>')

    def _clicked(self, event: Any) -> None:
        point = meet(self._terrain, np.array(event.ray_origin), np.array(event.ray_direction))
        if point is not None:
            goal = (float(point[0]), float(point[1]))
            self._wishes.put(lambda: self.send(goal))

    def _speak(self) -> None:
        """Show the status of each robot: a new state at once, and the numbers now and then."""
        self._frames += 1
        robots = [rider.driven for rider in self._riders]
        states = " ".join(driven.state for driven in robots)
        if states == self._spoken[0] and self._frames % SPEAK_EVERY:
            return
        text = "".join(
            f"<p><b>{html.escape(driven.name)}</b> {WORDS[driven.state]}; {driven.seconds:.0f} s,"
            f" margin {driven.sight.margin:+.2f} m</p>"
            for driven in robots
        )
        if text != self._spoken[1]:
            self._status.content = f'<div style="font-size: 0.875em; margin: 0.6em">{text}</div>'
        self._spoken = (states, text)
