"""Playback: a slider for the time, and the robot at its pose at that time."""

import logging
from collections.abc import Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.robots import Robot, load_robot, load_talos
from jaxleas.types import InputError
from jaxleas.viewer.clips import Clip
from jaxleas.viewer.footholds import Foothold
from jaxleas.viewer.ground import Colour
from jaxleas.viewer.painted import add_painted, shade
from jaxleas.viewer.ribbon import draw_path
from jaxleas.viewer.robot_shape import INVALID, RobotShape, limb_colour, mesh_of_hull

if TYPE_CHECKING:
    from viser import GlbHandle, ViserServer

_LOG = logging.getLogger("jaxleas")

PLAYED: Colour = (60, 110, 170)
THICKNESS = 0.015  # thickness of a sole [m]
SMALLEST = 0.02  # half size of a drawn sole at least, so that a point foot can be seen [m]
LIFTED = 0.25
"""Opacity of a foothold that the foot has left."""


def robot_to_draw(clips: Sequence[Clip], named: str | None = None) -> Robot:
    """Return the robot to draw: the named one, else that of the clips, else Talos.

    Args:
        clips: clips to be shown together.
        named: name of a robot, or path of its file, as a person gave it.

    Raises:
        InputError: the clips are of different robots, or there is no robot of the given name.
    """
    names = list(dict.fromkeys(clip.robot for clip in clips if clip.robot is not None))
    if len(names) > 1:
        raise InputError(f"these are of different robots, {' and '.join(names)}: show them apart")
    if named is not None:
        return load_robot(named)
    if not names:
        return load_talos()
    try:
        return load_robot(names[0])
    except InputError:  # a contact problem with polytopes of its own may be of any robot
        _LOG.warning("there is no robot %r here: Talos is drawn in its place", names[0])
        return load_talos()


def middle_of_sole(foothold: Foothold) -> np.ndarray:
    """Return the middle of a sole that lies on its surface, whatever way that faces [m]."""
    return foothold.pose.transform(np.array([[0.0, 0.0, 0.5 * THICKNESS]]))[0]


class Playback:
    """The panel for playback, and the actions of each frame."""

    def __init__(self, server: "ViserServer", robot: Robot, clips: Sequence[Clip]) -> None:
        """Draw all paths, the robot at the start of the first path, and the panel.

        Args:
            server: server of the page.
            robot: robot that is shown.
            clips: clips, of which one is played at a time.
        """
        self._server, self._clips = server, list(clips)
        self._shape = RobotShape(server, "/played", robot, PLAYED)
        self._time, self._feet = 0.0, []
        for index, clip in enumerate(clips):
            colour = PLAYED if clip.valid.all() else INVALID
            draw_path(server, f"/paths/{index}", clip.position, colour)
        with server.gui.add_folder("Play back"):
            self._add_panel()
        self._choose(0)

    @property
    def busy(self) -> bool:
        """Whether a clip is playing and has not ended."""
        return self._plays.value and self._time < self._clip.duration

    def frame(self, seconds: float) -> None:
        """Advance the clip, if it is playing.

        Args:
            seconds: time since the previous frame [s].
        """
        if self._chosen.value != self._clip.name:
            self._choose([clip.name for clip in self._clips].index(self._chosen.value))
        if self._wanted is not None:
            self._time, self._wanted = self._wanted, None
        elif self.busy:
            self._time = min(self._time + seconds * self._speed.value, self._clip.duration)
            self._slider.value = round(self._time, 2)
            if self._time >= self._clip.duration:
                self._plays.value = False
        else:
            return
        self._draw()

    def play(self) -> None:
        """Play from the beginning."""
        self._wanted, self._plays.value = 0.0, True

    def _add_panel(self) -> None:
        gui = self._server.gui
        names = tuple(clip.name for clip in self._clips)
        self._chosen = gui.add_dropdown("What", names, visible=len(names) > 1)
        longest = max(max(clip.duration for clip in self._clips), 0.01)
        self._slider = gui.add_slider("Time [s]", 0.0, round(longest + 0.005, 2), 0.01, 0.0)
        self._plays = gui.add_checkbox("Play", False)
        self._speed = gui.add_slider("Times the speed", 0.5, 20.0, 0.5, 4.0)
        self._wanted: float | None = None

        @self._slider.on_update
        def _(event: Any) -> None:
            if event.client is not None:  # a user moved the slider, not `frame`
                self._wanted = min(self._slider.value, self._clip.duration)

        @self._plays.on_update
        def _(event: Any) -> None:
            if event.client is not None and self._time >= self._clip.duration:
                self._wanted = 0.0

    def _choose(self, index: int) -> None:
        self._clip, self._time = self._clips[index], 0.0
        self._server.scene.remove_by_name("/footholds")
        self._feet = [
            (foothold, self._add_foothold(f"/footholds/{number}", foothold))
            for number, foothold in enumerate(self._clip.footholds)
        ]
        self._slider.value = 0.0
        self._draw()

    def _add_foothold(self, name: str, foothold: Foothold) -> "tuple[GlbHandle, GlbHandle]":
        """Add a sole twice, both hidden: as a standing foot, and as a foothold that was left."""
        half_size = (*np.maximum(foothold.half_size, SMALLEST), 0.5 * THICKNESS)
        sole = mesh_of_hull(np.array(list(product(*((-half, half) for half in half_size)))))
        colours = shade(sole, limb_colour(foothold.limb))
        nodes = (
            add_painted(self._server, f"{name}/standing", sole, colours),
            add_painted(self._server, f"{name}/left", sole, colours, LIFTED),
        )
        for node in nodes:
            node.position = middle_of_sole(foothold)
            node.wxyz = foothold.pose.quaternion
        return nodes

    def _draw(self) -> None:
        now = self._clip.at(self._time)
        self._shape.show(now is not None)
        if now is not None:
            pose, valid = now
            self._shape.place(pose)
            self._shape.mark(valid)
        for foothold, (standing, left) in self._feet:
            stands = foothold.time <= self._time + 1e-9 and self._time < foothold.until
            standing.visible, left.visible = stands, foothold.until <= self._time
