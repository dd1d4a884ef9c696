"""Labelled paths parted by terrain: to learn from, to calibrate by, to judge by."""

from dataclasses import dataclass

import numpy as np

from jaxleas.surrogates.labelled_paths import LabelledPaths
from jaxleas.types import InputError

LEAST_FAILURES = 20  # on the terrains used for learning
LEAST_TERRAINS = 4


@dataclass(frozen=True)
class Split:
    """Paths for learning, calibration and judgement, each on their own terrains."""

    learned: LabelledPaths
    calibration: LabelledPaths
    judged: LabelledPaths


def split_by_terrain(paths: LabelledPaths, share: float, seed: int) -> Split:
    """Split paths by terrain: no terrain of learning is in calibration or judgement.

    Args:
        paths: labelled paths over several terrains.
        share: share of the terrains that nothing is learned from.
        seed: seed of the choice of terrains.

    Raises:
        InputError: there are too few terrains, or too few verdicts of one class.
    """
    maps = np.unique(paths.map_index)
    if len(maps) < LEAST_TERRAINS:
        raise InputError(
            f"the labels come from {len(maps)} terrains; to learn on some and to judge on others"
            f" it takes {LEAST_TERRAINS} or more"
        )
    shuffled = np.random.default_rng(seed).permutation(maps)
    held = max(2, round(share * len(maps)))
    parts = shuffled[held:], shuffled[: held // 2], shuffled[held // 2 : held]
    split = Split(*(paths[np.isin(paths.map_index, part)] for part in parts))
    for name, part, least in (
        ("to learn from", split.learned, LEAST_FAILURES),
        ("to calibrate by", split.calibration, 2),
        ("to judge by", split.judged, 2),
    ):
        failures, passes = int(np.sum(part.failed_at >= 0)), int(np.sum(part.failed_at < 0))
        if min(failures, passes) < least:
            raise InputError(
                f"of the guide paths {name} the planner failed {failures} and passed {passes};"
                f" a surrogate needs {least} of each: label more of them"
            )
    return split
