"""Obstacles to walk around, and dead ends that cannot be crossed at all."""

from dataclasses import replace
from typing import Literal

from jaxleas.terrain.scenarios.scenario import (
    CONFIG,
    SIZE,
    Scenario,
    around,
    box,
    compose,
    floor,
    near_and_far,
    platform,
    random_stream,
    tile_frame,
)
from jaxleas.terrain.tiles import flat_tile

DeadEndKind = Literal["void", "wall", "platform"]
HOLE_HALF_WIDTH = 0.55
"""Half the width of the hole across the course [m]."""
MOST_SHIFT = 0.25
"""Largest distance of the hole's centre from the middle, to either side [m]."""


def hole(seed: int) -> Scenario:
    """Return a floor with a hole between starts and goal (T fig. 3.15, I sec. IV-B.2).

    The floor is 4 m along x and 4 m across, the hole in its middle 1 m along x and 1.1 m across,
    shifted sideways by up to 0.25 m: the rims are 1.2 to 1.7 m wide. (The sources give no size;
    from the middle of a wider hole no rim lies within the 0.6 m that LEAS sees to each side, and a
    local method has nothing to steer by.) Starts: 0.5 to 0.9 m before the hole, over 2.4 m of the
    width; goal: 0.2 m around a point 1 m behind the hole.
    """
    rim = _rim(seed)
    floors = [
        (0.0, 1.5, -2.0, 2.0),
        (2.5, 4.0, -2.0, 2.0),
        (1.5, 2.5, -2.0, rim[0]),
        (1.5, 2.5, rim[1], 2.0),
    ]
    scene = compose([floor(area) for area in floors])
    return Scenario("hole", scene, ((0.6, 1.0, -1.2, 1.2),), around(3.5, 0.0, 0.1))


def hole_rim(seed: int) -> Scenario:
    """Return the floor of `hole`, to be walked along one rim of the hole (T table 4.2, fig. 4.11).

    "A small area from where all our steering methods can generate valid guide paths": the straight
    lines run beside the hole, 0.03 to 0.5 m from its edge. Starts: 0.5 to 0.9 m before the hole and
    up to 0.5 m beside its edge; goal: 0.05 m around a point 1 m behind the hole, 0.1 m beside
    the edge. The seed chooses the rim.
    """
    low, high = _rim(seed)
    left = random_stream("hole_rim", seed).random() < 0.5
    edge, away = (high, 1.0) if left else (low, -1.0)
    side = sorted((edge, edge + 0.5 * away))
    goal = around(3.5, edge + 0.1 * away, 0.05)
    start = (0.6, 1.0, side[0], side[1])
    return replace(hole(seed), name="hole_rim", start_areas=(start,), goal_area=goal)


def wall(seed: int) -> Scenario:
    """Return level ground with a wall that leaves a passage at one side (T 4.3.2, scenario B2).

    The ground is 5 m along x and 4 m across; the wall, 0.2 m thick and 1.5 m high, stands
    halfway, from one side of the ground to between 0.1 m short of the middle and 0.2 m beyond: the
    passage is 1.8 to 2.1 m wide. The seed chooses the side. Starts: 1 to 1.7 m before the wall,
    in the middle metre; goal: the middle metre 1 to 2 m behind it. Most straight lines hit the
    wall or come closer than half a trunk (0.3 m).
    """
    rng = random_stream("wall", seed)
    side, end = rng.choice([-1.0, 1.0]), rng.uniform(-0.1, 0.2)
    low, high = sorted((side * end, -side * 2.0))
    parts = [floor((0.0, 5.0, -2.0, 2.0)), box((2.4, 2.6, low, high), 0.0, 1.5)]
    return Scenario("wall", compose(parts), ((0.7, 1.4, -0.5, 0.5),), around(4.0, 0.0, 0.5))


def dead_end(kind: DeadEndKind, seed: int) -> Scenario:
    """Return a flat tile before what cannot be crossed, over the whole width; the goal is behind.

    `void`: nothing comes after the tile. `wall`: 0.3 m thick, 0.7 to 2 m high, with a flat tile
    behind. `platform`: a tile 0.6 to 1 m higher. Starts: near (from 0.4 m, so that the trunk is
    clear of a wall whatever its heading) and far.
    """
    name = f"dead_end_{kind}"
    rng = random_stream(name, seed)
    parts = [flat_tile(tile_frame(0), 0.0)]
    if kind == "wall":
        half = 0.5 * SIZE
        parts += [box((SIZE, SIZE + 0.3, -half, half), 0.0, rng.uniform(*CONFIG.obstacles.height))]
        parts += [floor((SIZE + 0.3, 2.0 * SIZE + 0.3, -half, half))]
    elif kind == "platform":
        area = (SIZE, 2.0 * SIZE, -0.5 * SIZE, 0.5 * SIZE)
        parts += [platform(area, rng.uniform(0.6, 1.0))]
    goal = around(1.75 * SIZE, 0.0, 0.5)
    starts = near_and_far(SIZE, nearest=0.4)
    return Scenario(name, compose(parts), starts, goal, crossing=False)


def _rim(seed: int) -> tuple[float, float]:
    """Return the y of the hole's two edges [m]."""
    shift = random_stream("hole", seed).uniform(-MOST_SHIFT, MOST_SHIFT)
    return shift - HOLE_HALF_WIDTH, shift + HOLE_HALF_WIDTH
