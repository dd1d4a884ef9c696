"""Scores of motion models and their rivals on footsteps that they have not seen."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.features import CHOICES, Predictors, turned, wrapped
from jaxleas.footsteps.folds import SPLITS, Split
from jaxleas.footsteps.model import MOTION, FeetMode
from jaxleas.footsteps.pair_footsteps import PairFootsteps, Target
from jaxleas.footsteps.regression import Fit, fit_table, linear_out_of_fold, out_of_fold
from jaxleas.footsteps.scores import Score, mean_absolute_error, r2_percent

ALL = "all"
MILLI = 1000.0


def linear_scores(part: PairFootsteps) -> Iterator[Score]:
    """Yield the scores of the linear models of a pair: each choice of predictors, each split."""
    for split in SPLITS:
        for choice in CHOICES:
            # Targets that see the same predictors are solved together.
            groups: dict[tuple[int, ...], list[Target]] = {}
            for target in part.targets():
                groups.setdefault(tuple(part.columns(choice, target.name)), []).append(target)
            for columns, targets in groups.items():
                yield from _scores(part, (split, "linear", choice), list(columns), targets)


def rival_scores(part: PairFootsteps, network: Fit | None = None) -> Iterator[Score]:
    """Yield the scores of the table of means, and of a network if there is one, by run.

    Args:
        part: footsteps of one pair.
        network: fit of a network; it sees what C4 sees.
    """
    every = list(range(part.predictors.shape[1]))
    yield from _scores(part, ("run", "table", "C1"), every, part.targets())
    if network is not None:
        yield from _scores(part, ("run", "network", "C4"), every, part.targets(), network)


def _scores(
    part: PairFootsteps,
    of: tuple[Split, str, Predictors],
    columns: list[int],
    targets: list[Target],
    network: Fit | None = None,
) -> Iterator[Score]:
    split, model, choice = of
    labels = np.column_stack([target.labels for target in targets])
    asked = (part.predictors[:, columns], labels, part.folds[split])
    if model == "linear":
        predicted = linear_out_of_fold(*asked)
    else:
        predicted = out_of_fold(*asked, fit_table if network is None else network)
    for movement in (ALL, *np.unique(part.movement)):
        chosen = (part.movement == movement) | (movement == ALL)
        for index, target in enumerate(targets):
            truth, answer = labels[chosen, index], predicted[chosen, index]
            yield Score(
                *(target.name, part.name, model, choice, target.feet, split, str(movement)),
                count=int(chosen.sum()),
                r2=r2_percent(truth, answer),
                error=MILLI * float(mean_absolute_error(truth, answer)),
            )


def held_out_errors(
    part: PairFootsteps, choice: Predictors, mode: FeetMode
) -> dict[str, Float[np.ndarray, " M"]]:
    """Return how far footsteps end from where models that have not seen their runs put them.

    Args:
        part: footsteps of one pair.
        choice: predictors of the models.
        mode: how feet are predicted; their places are put together with the predicted pose.

    Returns:
        Distances of all swinging feet ("landing") and of the centre of mass ("com") [m], and
        differences of the heading ("yaw") [rad].
    """
    columns = part.columns(choice, "com yaw" if choice != "C1" else "foot")
    labels = part.outputs(mode)
    outputs = linear_out_of_fold(part.predictors[:, columns], labels, part.folds["run"])
    feet = outputs[:, MOTION:].reshape(part.lift_offs.shape)
    placed = placed_feet(outputs[:, :3], feet, part.lift_offs, mode)
    actual = part.lift_offs + part.landings["absolute"]
    return {
        "landing": np.linalg.norm(placed - actual, axis=-1).reshape(-1),
        "com": np.linalg.norm(outputs[:, :2] - part.com[:, :2], axis=-1),
        "yaw": np.abs(wrapped(outputs[:, 2] - part.com[:, 2])),
    }


def placed_feet(
    com: Float[np.ndarray, "N 3"],
    feet: Float[np.ndarray, "N S 2"],
    lift_offs: Float[np.ndarray, "N S 2"],
    mode: FeetMode,
) -> Float[np.ndarray, "N S 2"]:
    """Return where predicted feet land, in the robot's frame at the beginning [m].

    Args:
        com: predicted displacement of the centre of mass, x, y [m] and yaw [rad].
        feet: predicted places of the feet.
        lift_offs: their places at the beginning, in the same frame as the result [m].
        mode: what is predicted of the feet.
    """
    if mode == "absolute":
        return lift_offs + feet
    return com[:, None, :2] + turned(feet, com[:, None, 2])
