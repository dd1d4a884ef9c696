"""Obstacles across the whole course that a robot just can, or just cannot, cross.

Sizes and angles are drawn continuously, on both sides of what a humanoid can do: other scenarios
hold what is easily crossed or hopeless.
"""

import math
from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.limit import Bar, Limit
from jaxleas.terrain.scenarios.scenario import Scenario, around, compose, random_stream
from jaxleas.terrain.tiles import TilePolygons, bars_across, ground_across

HALF_LENGTH, HALF_WIDTH = 3.0, 2.0
"""Half the course along x and y [m]; the obstacle goes through its middle."""
MOST_ANGLE = math.radians(45.0)
"""Largest angle between the way ahead and the normal of the obstacle [rad]."""
BEYOND = 0.5
"""How far bars reach beyond the course to either side, so that there is no way round [m]."""


def ledge_up(seed: int) -> Scenario:
    """Return level ground with a ledge up of 0.25 to 0.6 m, at any angle up to 45 degrees."""
    return _scenario("ledge_up", seed, lambda rng: Limit(rise=rng.uniform(0.25, 0.6)))


def ledge_down(seed: int) -> Scenario:
    """Return level ground with a ledge down of 0.25 to 0.6 m, at any angle up to 45 degrees."""
    return _scenario("ledge_down", seed, lambda rng: Limit(rise=-rng.uniform(0.25, 0.6)))


def gap(seed: int) -> Scenario:
    """Return level ground with a gap of 0.1 to 0.5 m, at any angle up to 45 degrees."""
    return _scenario("gap", seed, lambda rng: Limit(gap=rng.uniform(0.1, 0.5)))


def hurdle(seed: int) -> Scenario:
    """Return level ground with a hurdle 0.1 to 0.7 m high and 2 to 30 cm thick, at any angle."""
    return _scenario("hurdle", seed, lambda rng: _barrier(rng, (0.1, 0.7)))


def thin_wall(seed: int) -> Scenario:
    """Return level ground with a wall 0.7 to 2 m high and 2 to 30 cm thick, at any angle."""
    return _scenario("thin_wall", seed, lambda rng: _barrier(rng, (0.7, 2.0)))


def railing(seed: int) -> Scenario:
    """Return level ground with a railing 0.9 to 1.1 m high, at any angle.

    Two bars, 2 to 5 cm thick, at half the height and at the top, on posts 1 m apart.
    """

    def draw(rng: np.random.Generator) -> Limit:
        thick, high = rng.uniform(0.02, 0.05), rng.uniform(0.9, 1.1)
        bars = (
            Bar(thick, math.inf, high - thick, high),
            Bar(thick, math.inf, 0.5 * high - thick, 0.5 * high),
            Bar(thick, thick, 0.0, high),
        )
        return Limit(bars=bars, period=1.0)

    return _scenario("railing", seed, draw)


def posts(seed: int) -> Scenario:
    """Return level ground with a row of posts, 0.2 to 1 m of room between them, at any angle.

    The posts are square, 3 to 12 cm thick, and 0.9 to 2 m high.
    """

    def draw(rng: np.random.Generator) -> Limit:
        thick, high, room = rng.uniform(0.03, 0.12), rng.uniform(0.9, 2.0), rng.uniform(0.2, 1.0)
        return Limit(bars=(Bar(thick, thick, 0.0, high),), period=thick + room)

    return _scenario("posts", seed, draw)


LIMITS: Mapping[str, Callable[[int], Scenario]] = MappingProxyType(
    {
        "ledge_up": ledge_up,
        "ledge_down": ledge_down,
        "gap": gap,
        "hurdle": hurdle,
        "thin_wall": thin_wall,
        "railing": railing,
        "posts": posts,
    }
)
"""The scenarios of this file by name."""


def limit_scenario(name: str, limit: Limit, angle: float, shift: float = 0.0) -> Scenario:
    """Return level ground with an obstacle across it.

    The course is 6 m along x and 4 m across. Starts: 1.2 to 1.9 m before the middle of the
    obstacle and up to 0.3 m to either side; goal: 0.3 m around a point 1.5 m behind its middle.

    Args:
        name: name of the scenario.
        limit: obstacle, whose line goes through the middle of the course.
        angle: angle from the way ahead (x) to the normal of the obstacle [rad].
        shift: distance along the obstacle from the middle to the centre of a post [m].
    """
    goal = 1.5 + limit.gap
    return Scenario(
        name,
        compose([_ground(limit, angle), _bars(limit, angle, shift)]),
        ((-1.9, -1.2, -0.3, 0.3),),
        around(goal, 0.0, 0.3),
        limit=limit,
    )


def _scenario(name: str, seed: int, draw: Callable[[np.random.Generator], Limit]) -> Scenario:
    rng = random_stream(name, seed)
    limit = draw(rng)
    shift = rng.uniform(0.0, limit.period) if math.isfinite(limit.period) else 0.0
    return limit_scenario(name, limit, rng.uniform(-MOST_ANGLE, MOST_ANGLE), shift)


def _barrier(rng: np.random.Generator, heights: tuple[float, float]) -> Limit:
    bar = Bar(rng.uniform(0.02, 0.3), math.inf, 0.0, rng.uniform(*heights))
    return Limit(bars=(bar,))


def _ground(limit: Limit, angle: float) -> TilePolygons:
    """Return the ground before and behind the obstacle, and the side of a ledge."""
    before, behind = ground_across(limit, angle, (HALF_LENGTH, HALF_WIDTH))
    if not limit.rise:
        return TilePolygons([before, behind])
    normal = np.array([math.cos(angle), math.sin(angle), 0.0])
    edge = before[np.abs(before @ normal) < 1e-9]
    side = np.vstack(
        [_raised(edge, min(0.0, limit.rise)), _raised(edge, max(0.0, limit.rise))[::-1]]
    )
    return TilePolygons([before, behind], [{"side": side}])


def _raised(points: Float[np.ndarray, "V 3"], height: float) -> Float[np.ndarray, "V 3"]:
    return points + np.array([0.0, 0.0, height])


def _bars(limit: Limit, angle: float, shift: float) -> TilePolygons:
    reach = HALF_WIDTH / math.cos(angle) + BEYOND
    return TilePolygons(boxes=bars_across(limit, angle, reach, shift))
