"""The effect of the L1 norm (T 5.3.2): the cost map and the scenarios A.1, A.2 and B."""

import numpy as np
from jaxtyping import Float

from benchmarks.contacts.flat_worlds import content, rectangle
from jaxleas.contacts import ContactProblem

START = {"S1": rectangle(-0.3, 0.0, -0.2, 0.2)}
SAMPLES = (  # of figure 5.10: one surface, two, three in a row, four around
    [(0.3, 0.7, 0.3, 0.7)],
    [(0.1, 0.35, 0.3, 0.7), (0.65, 0.9, 0.3, 0.7)],
    [(0.05, 0.25, 0.1, 0.5), (0.4, 0.6, 0.5, 0.9), (0.75, 0.95, 0.2, 0.6)],
    [(0.1, 0.3, 0.1, 0.3), (0.7, 0.9, 0.1, 0.3), (0.1, 0.3, 0.7, 0.9), (0.7, 0.9, 0.7, 0.9)],
)


def cost_map(
    problem: ContactProblem, names: tuple[str, ...], points: Float[np.ndarray, "*batch 3"]
) -> Float[np.ndarray, "*batch"]:
    """Return the sum over surfaces of a point's distance from each (T eq. 5.12) [m]."""
    return np.sum([problem.surfaces[name].distance(points) for name in names], axis=0)


def scenario_a(gap: float) -> dict:
    """Return A.1: two steps to S4, the first on S2 or S3, `gap` [m] apart (T figs. 5.11, 5.12)."""
    surfaces = {
        **START,
        "S2": rectangle(0.05, 0.25, -0.2, 0.3),
        "S3": rectangle(0.25 + gap, 0.45 + gap, -0.2, 0.3),
        "S4": rectangle(0.4, 0.8, -0.3, 0.2),
    }
    return content(surfaces, [["S2", "S3"], ["S4"]], model="feet")


def scenario_a2() -> dict:
    """Return A.2: as A.1, further apart; S5 leaves only the place of least cost between them."""
    surfaces = {
        **START,
        "S2": rectangle(0.0, 0.1, -0.2, 0.1),
        "S3": rectangle(0.2, 0.3, -0.2, 0.1),
        "S4": rectangle(0.35, 0.6, -0.3, 0.2),
        "S5": rectangle(0.0, 0.3, 0.4, 0.6),
    }
    return content(surfaces, [["S2", "S3", "S5"], ["S4"]], model="feet")


def scenario_b() -> dict:
    """Return B: five steps over ten surfaces, two of them among six islands (T fig. 5.13)."""
    islands = {
        f"S{4 + index}": rectangle(x, x + 0.12, y, y + 0.12)
        for index, (x, y) in enumerate(
            [(0.42, -0.25), (0.42, 0.1), (0.62, -0.3), (0.6, 0.16), (0.8, -0.22), (0.8, 0.1)]
        )
    }
    surfaces = {
        **START,
        "S2": rectangle(0.05, 0.25, -0.05, 0.2),
        "S3": rectangle(0.05, 0.25, 0.25, 0.5),
        **islands,
        "S10": rectangle(1.0, 1.4, -0.4, 0.4),
    }
    some = list(islands)
    return content(surfaces, [["S2", "S3"], some[:2], some, some, ["S10"]], model="feet")
