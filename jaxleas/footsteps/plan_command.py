"""The function behind `jaxleas gait footsteps`."""

from pathlib import Path

from jaxleas.footsteps.cost_map import FootCostMap, buffer_of
from jaxleas.footsteps.cost_pictures import draw_cost_map
from jaxleas.footsteps.model_file import read_motion_model
from jaxleas.footsteps.pose_text import parse_pose
from jaxleas.footsteps.search import SearchSettings, plan_footsteps, settings_for
from jaxleas.footsteps.search_costs import Cost
from jaxleas.footsteps.shipped_models import shipped_model_of
from jaxleas.footsteps.state_file import named_in_state, read_state, write_plan
from jaxleas.footsteps.walking_state import require_footing, require_goal, require_start
from jaxleas.terrain import READING, Reading, import_terrain, require_picture, with_cells


def plan(
    terrain: Path,
    *,
    state: Path,
    goal: str,
    out: Path,
    models: Path | None = None,
    horizon: int = 2,
    exact: bool = False,
    cost: Cost = "footsteps",
    buffer: float | None = None,
    picture: Path | None = None,
    reading: Reading = READING,
) -> None:
    """Plan the next footsteps of a walking controller from a measured state.

    Args:
        terrain: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        state: file of the measured state (docs/files.md).
        goal: pose to reach: X,Y or X,Y,YAW [m, rad].
        out: file of the plan (.json).
        models: motion models of the controller, as `jaxleas gait fit` writes them; by default
            those of the package for the state's controller and robot.
        horizon: number of footsteps to plan where the goal is farther.
        exact: search until no plan can be better, however long that takes; a horizon of up to two
            footsteps is always searched so.
        cost: footsteps, or the thesis's greedy cost.
        buffer: distance of a foot's centre from edges [m]; by default 1.5 cm, within which
            a landing is unsafe, and the 95 % quantile of the error of its prediction.
        picture: file for a picture of the map: as measured, filtered, and where feet may land.
        reading: what the terrain file does not state itself.
    """
    if picture is not None:
        require_picture(picture)
    model = (
        shipped_model_of(*named_in_state(state)) if models is None else read_motion_model(models)
    )
    start = read_state(state, model.controller)
    target = parse_pose(goal, "--goal")
    height_map = import_terrain(terrain, with_cells(terrain, reading, CELL))
    costs = FootCostMap.of(height_map, buffer_of(model) if buffer is None else buffer)
    require_goal(target, costs)
    require_footing(target, costs)
    require_start(start, costs, model.controller)
    if picture is not None:
        draw_cost_map(height_map, costs, picture)
    quick = settings_for(horizon)
    chosen = SearchSettings(
        horizon=horizon,
        cost=cost,
        width=None if exact else quick.width,
        most_expansions=MOST_EXACT if exact else quick.most_expansions,
    )
    found = plan_footsteps(model, costs, start, target, chosen)
    write_plan(out, found, model.controller)
    print(f"{found.in_words()}; {found.expansions} states expanded; written to {out}")


CELL = 0.02
"""Edge of a cell of polygons where none is stated [m]: half a foot."""
MOST_EXACT = 1_000_000
"""States after which even an exact search ends: its heap would fill the memory."""
