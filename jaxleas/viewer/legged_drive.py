"""Driving a quadruped in physics: users click goals, and its footsteps are planned there."""

import html
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.footsteps import Goal
from jaxleas.terrain import HeightMap
from jaxleas.viewer.legged_shape import NEARNESS, LeggedShape
from jaxleas.viewer.live_walk import LiveWalk
from jaxleas.viewer.ribbon import Trail
from jaxleas.viewer.robot_shape import ROBOTS, draw_goal
from jaxleas.viewer.terrain_mesh import meet

if TYPE_CHECKING:
    from viser import ViserServer

STOPS = 0.25
"""Speed from which it stops at a goal [m/s]."""
AHEAD = 0.5
"""Distance of a goal from which on the robot arrives facing the way it came [m]."""
TRAIL_EVERY = 9
"""Frames between two drawings of the trail, which the page rebuilds."""
WORDS = {
    "waiting": "stands, waiting for a goal",
    "walking": "walks",
    "arrived": "has arrived",
    "no path": "stands: no command is safe",
    "fell": "fell: put it back at the start",
    "failed": "stands",
}


class LeggedDrive:
    """The panel for a quadruped, and the actions of each frame.

    Args:
        server: server of the page.
        terrain: terrain that users click on.
        walk: robot that walks.
        shape: its shape.
        is_live: whether it keeps the page's time; else the page waits for it.
    """

    def __init__(
        self,
        server: "ViserServer",
        terrain: HeightMap,
        walk: LiveWalk,
        shape: LeggedShape,
        is_live: bool,
    ) -> None:
        self._terrain, self._walk, self._shape, self._is_live = terrain, walk, shape, is_live
        self._goals: SimpleQueue[tuple[float, float]] = SimpleQueue()
        self._text, self._refusal, self._frames = "", "", 0
        now = walk.snapshot
        self._goal = draw_goal(server, now.coordinates[:3])
        self._trail = Trail(server, "/trail/walker", ROBOTS[0])
        self._trail.begin(now.coordinates[:3])
        with server.gui.add_folder("Walk"):
            self._add_panel(server)
        server.scene.on_click()(self._clicked)
        self.frame(0.0)

    @property
    def busy(self) -> bool:
        """Whether the robot still walks."""
        return self._walk.busy

    def frame(self, seconds: float) -> None:
        """Advance the page.

        Args:
            seconds: time since the previous frame [s].
        """
        while not self._goals.empty():
            self.send(self._goals.get())
        if self._walk.busy:
            self._walk.advance(seconds * self._speed.value, waits=not self._is_live)
        now = self._walk.snapshot
        self._shape.place(now.coordinates, now.feet)
        self._frames += 1
        if now.state == "walking":
            self._trail.add(now.coordinates[:3])
        if now.state != "walking" or self._frames % TRAIL_EVERY == 0:
            self._trail.draw()
        self._speak()

    def send(self, goal: tuple[float, float]) -> None:
        """Send the robot to a goal (x, y) [m]; one without ground is refused on the page."""
        (ground,) = self._terrain.height_at(np.array([goal])).tolist()
        if not np.isfinite(ground):
            self._refusal = f"no ground at ({goal[0]:.2f}, {goal[1]:.2f}) m"
            return
        self._refusal = ""
        self._goal.position, self._goal.visible = (*goal, ground), True
        self._walk.send(self._pose(goal))

    def reset(self) -> None:
        """Put the robot back at the start."""
        self._goal.visible, self._refusal = False, ""
        self._walk.reset()

    def _pose(self, goal: tuple[float, float]) -> Goal:
        """Return the pose to reach: a far goal facing the way there, a near one as it stands."""
        x, y, _, w, qx, qy, qz = self._walk.snapshot.coordinates[:7].tolist()
        yaw = np.arctan2(2.0 * (w * qz + qx * qy), 1.0 - 2.0 * (qy**2 + qz**2))
        if np.hypot(goal[0] - x, goal[1] - y) >= AHEAD:
            yaw = np.arctan2(goal[1] - y, goal[0] - x)
        return Goal(*goal, float(yaw), speed=STOPS)

    def _add_panel(self, server: "ViserServer") -> None:
        gui = server.gui
        colours = ", ".join(
            f"{word} {'beyond' if np.isinf(bound) else f'up to {100 * bound:g} cm'}"
            for bound, _, word in NEARNESS
        )
        gui.add_markdown(
            f"Click the ground. Feet by their distance from the nearest edge: {colours}."
        )
        gui.add_button("Stop").on_click(lambda _: self._walk.stop())
        gui.add_button("Back to the start").on_click(lambda _: self.reset())
        self._speed = gui.add_slider("Times real speed", 0.1, 4.0, 0.1, 1.0)
        self._status = gui.add_html("")

    def _clicked(self, event: Any) -> None:
        point = meet(self._terrain, np.array(event.ray_origin), np.array(event.ray_direction))
        if point is not None:
            self._goals.put((float(point[0]), float(point[1])))

    def _speak(self) -> None:
        """Show the status, if it has changed."""
        now = self._walk.snapshot
        words = "; ".join(filter(None, [WORDS[now.state], now.why, self._refusal]))
        text = f"<p><b>Quadruped</b> {html.escape(words)}; {now.seconds:.0f} s</p>"
        if text != self._text:
            self._text = text
            self._status.content = f'<div style="font-size: 0.875em; margin: 0.6em">{text}</div>'
