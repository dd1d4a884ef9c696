"""Playing back: a slider through time, and the robot where it was then."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from jaxleas.robots import Robot
from jaxleas.viewer.clips import Clip
from jaxleas.viewer.figure import INVALID, LIMBS, Colour, Figure, draw_line

if TYPE_CHECKING:
    from viser import ViserServer

PLAYED: Colour = (60, 110, 170)
THICKNESS = 0.015  # of a sole [m]
LIFT = np.array([0.0, 0.0, 0.5 * THICKNESS])
LIFTED, STANDING = 0.25, 1.0
"""Opacity of a foothold that the foot has left, and of one it stands on."""


class Playback:
    """The panel for playing back, and what happens in a frame."""

    def __init__(self, server: "ViserServer", robot: Robot, clips: Sequence[Clip]) -> None:
        """Draw all paths, the robot at the start of the first, and the panel.

        Args:
            server: of the page.
            robot: that is shown.
            clips: one is played at a time.
        """
        self._server, self._clips = server, list(clips)
        self._figure = Figure(server, "/played", robot, PLAYED)
        self._time, self._feet = 0.0, []
        for index, clip in enumerate(clips):
            colour = PLAYED if clip.valid.all() else INVALID
            draw_line(server, f"/paths/{index}", clip.position, colour)
        with server.gui.add_folder("Play back"):
            self._add_panel()
        self._choose(0)

    @property
    def busy(self) -> bool:
        """Whether it plays and has not come to the end."""
        return self._plays.value and self._time < self._clip.duration

    def frame(self, seconds: float) -> None:
        """Let time pass, if it plays.

        Args:
            seconds: since the frame before.
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
            if event.client is not None:  # a person moved it, not the frame below
                self._wanted = min(self._slider.value, self._clip.duration)

        @self._plays.on_update
        def _(event: Any) -> None:
            if event.client is not None and self._time >= self._clip.duration:
                self._wanted = 0.0

    def _choose(self, index: int) -> None:
        self._clip, self._time = self._clips[index], 0.0
        for _, node in self._feet:
            node.remove()
        length, width = (2.0 * half for half in self._clip.half_size)
        self._feet = [
            (
                foothold,
                self._server.scene.add_box(
                    f"/footholds/{number}",
                    color=LIMBS[foothold.limb],
                    dimensions=(length, width, THICKNESS),
                    position=foothold.position + LIFT,
                    wxyz=(np.cos(0.5 * foothold.yaw), 0.0, 0.0, np.sin(0.5 * foothold.yaw)),
                    opacity=STANDING,
                ),
            )
            for number, foothold in enumerate(self._clip.footholds)
        ]
        self._slider.value = 0.0
        self._draw()

    def _draw(self) -> None:
        now = self._clip.at(self._time)
        self._figure.show(now is not None)
        if now is not None:
            pose, valid = now
            self._figure.place(pose)
            self._figure.mark(valid)
        for foothold, node in self._feet:
            node.visible = foothold.time <= self._time + 1e-9
            node.opacity = STANDING if self._time < foothold.until else LIFTED
