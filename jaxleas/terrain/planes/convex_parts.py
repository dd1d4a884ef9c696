"""Polygons with holes cut into few convex parts (Hertel and Mehlhorn 1983), in plan."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

WORTH = 0.85
"""Part of a polygon that a single convex one must cover to stand for it."""
FLAT = 1e-9
"""Area of a triangle from which on its corner counts as bent [cells^2]."""
NEAR = 0.02
"""Distance below which two corners are one [cells]."""


def convex_parts(
    outer: Float[np.ndarray, "V 2"], holes: Sequence[Float[np.ndarray, "H 2"]]
) -> list[Float[np.ndarray, "W 2"]]:
    """Return convex polygons inside a polygon and outside its holes.

    They fill it, unless a single one fills nearly all: what wiggles of an outline are worth.

    Args:
        outer: corners, counter-clockwise [cells].
        holes: corners of holes inside, clockwise [cells].
    """
    if not holes:
        core = kernel(outer)
        if area(core) >= WORTH * area(outer):
            return [core]
    import mapbox_earcut

    points = np.ascontiguousarray(np.concatenate([outer, *holes]), np.float64)
    ends = np.cumsum([len(outer), *map(len, holes)]).astype(np.uint32)
    triangles = mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3)
    return [points[loop] for loop in _merged(points, triangles)]


def area(corners: Float[np.ndarray, "V 2"]) -> float:
    """Return the area of a polygon, positive if its corners run counter-clockwise."""
    if len(corners) < 3:
        return 0.0
    x, y = (corners - corners[0]).T
    return 0.5 * float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def kernel(corners: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "W 2"]:
    """Return the part of a polygon that lies to the left of all its edges, which is convex."""
    kept = [tuple(each) for each in corners.tolist()]
    ahead = np.roll(corners, -1, axis=0)
    for (ax, ay), (bx, by) in zip(corners.tolist(), ahead.tolist(), strict=True):
        if len(kept) < 3:
            break
        side = [(bx - ax) * (y - ay) - (by - ay) * (x - ax) for x, y in kept]
        if min(side) >= -FLAT:
            continue
        cut = []
        for index, (x, y) in enumerate(kept):
            before, (u, v) = side[index - 1], kept[index - 1]
            if (before < 0.0) != (side[index] < 0.0):
                share = before / (before - side[index])
                cut.append((u + share * (x - u), v + share * (y - v)))
            if side[index] >= 0.0:
                cut.append((x, y))
        kept = cut
    return distinct(np.array(kept).reshape(-1, 2))


def distinct(corners: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "W 2"]:
    """Return the corners of a polygon without those that nearly are the one before."""
    if len(corners) < 2:
        return corners
    apart = np.abs(corners - np.roll(corners, 1, axis=0)).max(axis=1) > NEAR
    return corners[apart]


def _merged(points: Float[np.ndarray, "P 2"], triangles: Int[np.ndarray, "T 3"]) -> list[list[int]]:
    """Return loops of triangles merged over the diagonals that no corner needs."""
    at = points.tolist()
    loops: dict[int, list[int]] = {}
    sides: dict[tuple[int, int], int] = {}
    for number, (a, b, c) in enumerate(triangles.tolist()):
        turn = _turn(at, a, b, c)
        if abs(turn) > FLAT:
            loops[number] = [a, b, c] if turn > 0.0 else [a, c, b]
    for number, loop in loops.items():
        sides |= dict.fromkeys(_sides(loop), number)
    for a, b in sorted(sides, key=lambda side: -_squared_length(at, *side)):
        left, right = sides[a, b], sides.get((b, a))
        if right is None or left == right or a > b:
            continue
        loop = _without_side(loops[left], loops[right], a, b)
        if _is_convex_at(at, loop, a) and _is_convex_at(at, loop, b):
            loops[left] = loop
            sides |= dict.fromkeys(_sides(loops.pop(right)), left)
    return [_without_flat(at, loop) for loop in loops.values()]


def _sides(loop: list[int]) -> list[tuple[int, int]]:
    return list(zip(loop, loop[1:] + loop[:1], strict=True))


def _without_side(left: list[int], right: list[int], a: int, b: int) -> list[int]:
    """Return the loop around two loops that share the side from a to b, and b to a."""
    first, second = left.index(b), right.index(a)
    return left[first:] + left[:first] + (right[second:] + right[:second])[1:-1]


def _is_convex_at(at: list[list[float]], loop: list[int], corner: int) -> bool:
    index = loop.index(corner)
    return _turn(at, loop[index - 1], corner, loop[(index + 1) % len(loop)]) >= -FLAT


def _without_flat(at: list[list[float]], loop: list[int]) -> list[int]:
    """Drop corners in the middle of a straight side."""
    kept = [
        corner
        for index, corner in enumerate(loop)
        if _turn(at, loop[index - 1], corner, loop[(index + 1) % len(loop)]) > FLAT
    ]
    return kept if len(kept) >= 3 else loop


def _turn(at: list[list[float]], a: int, b: int, c: int) -> float:
    """Return twice the area of a triangle, positive for a turn to the left."""
    (ax, ay), (bx, by), (cx, cy) = at[a], at[b], at[c]
    return (bx - ax) * (cy - by) - (by - ay) * (cx - bx)


def _squared_length(at: list[list[float]], a: int, b: int) -> float:
    return (at[a][0] - at[b][0]) ** 2 + (at[a][1] - at[b][1]) ** 2
