"""A course of mixed obstacles with two corners: ahead, sideways, and ahead again.

Taouil's thesis, section 5.2.3, shows such a course in a picture, and gives no dimensions. Here two
steps lead up and down, then the robot goes to its left without turning, over a gap and a plank,
and then ahead over two gaps.
"""

from jaxleas.crossing.course import Course, level_scene, stop_at
from jaxleas.terrain import Area

RISER, TREAD = 0.042, 1.0 / 3.0
"""Height and depth of a step, those of the thesis's first stairs [m]."""
LOW = -0.18
"""Height of the ground between blocks [m] (thesis, section 5.2)."""
SIDE_GAP, GAP = 0.06, 0.08
"""Width of the gap that is crossed sideways, and of those ahead [m]."""
ACROSS = 3.2
"""Way to the left between the two corners [m]."""


def obstacle_course(name: str) -> Course:
    """Return the course.

    Args:
        name: name of the course.
    """
    up, top, down = 1.0, 1.0 + TREAD, 2.0
    level = down + TREAD
    corner = 3.2  # x of the way to the left
    far = 4.0  # end of the blocks that lie along it
    side, over = 1.0, 1.0 + SIDE_GAP
    plank = (over + 0.8, over + 1.4)
    left = (ACROSS - 1.0, ACROSS + 1.0)  # y of the blocks that are crossed at the end
    first = (far + GAP, far + GAP + 0.8)
    second = first[1] + GAP
    end = second + 1.6
    surfaces: dict[str, tuple[Area, float]] = {
        "start": ((-0.8, up, -1.0, side), 0.0),
        "up": ((up, top, -1.0, side), RISER),
        "top": ((top, down, -1.0, side), 2.0 * RISER),
        "down": ((down, level, -1.0, side), RISER),
        "corner": ((level, far, -1.0, side), 0.0),
        "beyond_the_gap": ((level, far, over, plank[0]), 0.0),
        "plank": ((level, far, *plank), RISER),
        "second_corner": ((level, far, plank[1], left[1]), 0.0),
        "block": ((*first, *left), 0.0),
        "goal": ((second, end, *left), 0.0),
        "ground": ((-0.8, end, -1.0, left[1]), LOW),
    }
    corners = ((corner, 0.0), (corner, ACROSS))
    return Course(name, level_scene(surfaces), stop_at(end - 0.8, ACROSS), corners)
