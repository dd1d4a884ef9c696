"""A quadruped on the page: what it is made of, from the options of `jaxleas view`."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from jaxleas.controllers import Walk, find_controller
from jaxleas.crossing import (
    WalkSettings,
    costs_of,
    measured_at_start,
    model_of,
    planner_of,
    standing_on,
)
from jaxleas.footsteps import FootCostMap, require_start
from jaxleas.physics import DEFAULT_BODY, BodyState, load_body, make_physics
from jaxleas.terrain import (
    HeightMap,
    Reading,
    SceneEdges,
    has_polygons,
    import_terrain,
    load_scene,
    with_cells,
)
from jaxleas.types import InputError
from jaxleas.viewer.legged_drive import LeggedDrive
from jaxleas.viewer.legged_shape import LeggedShape
from jaxleas.viewer.live_walk import LiveWalk
from jaxleas.viewer.walker_options import WalkerOptions

if TYPE_CHECKING:
    from viser import ViserServer

CELL = 0.01
"""Edge of a cell of polygons, on which footsteps are planned, where none is stated [m]."""


class Quadruped:
    """A quadruped that is ready to walk on a terrain.

    Args:
        terrain: file of the terrain.
        reading: what the file does not state itself.
        options: which quadruped it is.

    Raises:
        InputError: the terrain, the robot, its controller or its start cannot be used.
    """

    def __init__(self, terrain: Path, reading: Reading, options: WalkerOptions) -> None:
        self.body = load_body(options.robot or DEFAULT_BODY)
        controller = options.controller
        walker = find_controller(controller, self.body, (controller,))
        polygons = has_polygons(terrain)
        self.scene = load_scene(terrain, replace(reading, resolution=None) if polygons else reading)
        model = model_of(options.models, walker)
        settings = WalkSettings()
        self._map = import_terrain(terrain, with_cells(terrain, reading, CELL))
        costs = costs_of(model, self._map, [], settings)
        self.walk = Walk(make_physics(self.body, 1, self.scene), walker)
        self.start = self._started(options.start, costs)
        self.planner = planner_of(options.proposal, model, costs, settings)

    def _started(self, start: tuple[float, float, float] | None, costs: FootCostMap) -> BodyState:
        """Return the robot at the start, or at the first place that has room."""
        if start is not None:
            x, y, degrees = start
            return self._stood((x, y, float(np.radians(degrees))), costs)
        x_min, x_max, y_min, y_max = self._map.extent
        places = [(0.0, 0.0, 0.0), (0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.0)]
        refusals = []
        for place in places:
            try:
                return self._stood(place, costs)
            except InputError as error:
                refusals.append(str(error))
        raise InputError(f"give --start X Y DEGREES: {refusals[0]}")

    def _stood(self, place: tuple[float, float, float], costs: FootCostMap) -> BodyState:
        stands = standing_on(self.scene, self.body, [place])
        require_start(measured_at_start(self.walk, stands), costs, self.walk.controller.identity)
        return stands

    @contextmanager
    def on(
        self,
        server: "ViserServer",
        ground: HeightMap,
        goal: tuple[float, float] | None,
        is_live: bool,
    ) -> "Iterator[LeggedDrive]":
        """Yield the quadruped on the page; its thread ends with the block.

        Args:
            server: server of the page.
            ground: terrain that users click on.
            goal: first goal (x, y) [m].
            is_live: whether it keeps the page's time.
        """
        shape = LeggedShape(server, self.body, SceneEdges.of(self.scene))
        walk = LiveWalk(self.walk, self.start, self.planner)
        try:
            drive = LeggedDrive(server, ground, walk, shape, is_live)
            if goal is not None:
                drive.send(goal)
            yield drive
        finally:
            walk.close()

    @property
    def place(self) -> tuple[float, float]:
        """x and y of the root at the start [m]."""
        x, y = self.start.position[0, :2].tolist()
        return x, y
