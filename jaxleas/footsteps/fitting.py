"""Motion models from records of footsteps, judged on runs that they have not seen."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.features import COM, Predictors, com_labels
from jaxleas.footsteps.judging import held_out_errors, linear_scores, rival_scores
from jaxleas.footsteps.model import BACKWARD, Errors, FeetMode, MotionModel
from jaxleas.footsteps.pair_footsteps import MODES, PairFootsteps
from jaxleas.footsteps.records import FootstepRecords, Footsteps, movement_of
from jaxleas.footsteps.regression import least_squares
from jaxleas.footsteps.scores import Score
from jaxleas.types import MOVEMENTS, ControllerIdentity, InputError

FEWEST = 100
"""Footsteps of a pair that each movement needs: five for each number that is fitted."""
QUANTILES = (0.5, 0.95, 0.99)


@dataclass(frozen=True)
class FitSettings:
    """What is fitted, and what it is compared with.

    Attributes:
        movements: movements that the models must answer for.
        predictors: choice of predictors of the models that are kept.
        seed: seed of the folds and of the network.
        network: fit a small network, too, for comparison.
    """

    movements: tuple[str, ...] = MOVEMENTS
    predictors: Predictors = "C4"
    seed: int = 0
    network: bool = True


@dataclass(frozen=True, eq=False)
class Fitted:
    """Motion models and how well they do.

    Attributes:
        model: the models.
        scores: scores of all models and their rivals, by pair, split and movement.
        landing: mean distance between predicted and actual landings on unseen runs [m], by how
            landings are predicted.
    """

    model: MotionModel
    scores: tuple[Score, ...]
    landing: dict[FeetMode, float]


def fit_motion_models(records: FootstepRecords, settings: FitSettings) -> Fitted:
    """Fit motion models to records of footsteps.

    Landings are predicted in the way, absolute or relative, that is nearer on unseen runs.

    Raises:
        InputError: there are too few footsteps of a movement, or a single run.
    """
    steps, controller = records.footsteps, records.controller
    _require_enough(steps, controller, settings.movements)
    pairs = range(len(controller.pairs))
    parts = [PairFootsteps.of(steps, pair, controller, settings.seed) for pair in pairs]
    errors = {mode: _errors(parts, settings.predictors, mode) for mode in MODES}
    landing: dict[FeetMode, float] = {mode: float(errors[mode]["landing"].mean()) for mode in MODES}
    best = min(MODES, key=lambda mode: landing[mode])
    displacement = com_labels(steps)
    model = MotionModel(
        controller=controller,
        predictors=settings.predictors,
        feet=best,
        weights=tuple(_weights(part, settings.predictors, best) for part in parts),
        fastest=_fastest(steps, settings.movements),
        longest_stride=float(np.linalg.norm(displacement[:, :2], axis=1).max()),
        largest_turn=float(np.abs(displacement[:, 2]).max()),
        errors=Errors(**{name: _quantiles(each) for name, each in errors[best].items()}),
    )
    return Fitted(model, tuple(_all_scores(parts, settings)), landing)


def _all_scores(parts: list[PairFootsteps], settings: FitSettings) -> list[Score]:
    network = None
    if settings.network:
        from jaxleas.footsteps.network import fit_network  # JAX, which nothing else here needs

        network = partial(fit_network, seed=settings.seed)
    scores: list[Score] = []
    for part in parts:
        scores += [*linear_scores(part), *rival_scores(part, network)]
    return scores


def _errors(
    parts: list[PairFootsteps], choice: Predictors, mode: FeetMode
) -> dict[str, Float[np.ndarray, " N"]]:
    each = [held_out_errors(part, choice, mode) for part in parts]
    return {name: np.concatenate([part[name] for part in each]) for name in each[0]}


def _quantiles(errors: Float[np.ndarray, " N"]) -> dict[str, float]:
    return {f"{each:g}": float(np.quantile(errors, each)) for each in QUANTILES}


def _weights(part: PairFootsteps, choice: Predictors, mode: FeetMode) -> Float[np.ndarray, "P+1 L"]:
    """Return the weights of a pair's models, over all predictors: those unseen get 0."""
    labels = part.outputs(mode)
    weights = np.zeros((part.predictors.shape[1] + 1, labels.shape[1]))
    outputs: dict[tuple[int, ...], list[int]] = {}
    for output in range(labels.shape[1]):
        target = COM[output] if output < len(COM) else "foot"
        outputs.setdefault(tuple(part.columns(choice, target)), []).append(output)
    for columns, same in outputs.items():
        found = least_squares(part.predictors[:, list(columns)], labels[:, same])
        weights[np.ix_([*columns, -1], same)] = found
    return weights


def _fastest(steps: Footsteps, movements: tuple[str, ...]) -> dict[str, float]:
    """Return the largest speed that was commanded of each movement, and backward if it was."""
    speed, movement = np.abs(steps.command).max(axis=1), steps.movement
    backward = (steps.command[:, 0] < 0.0) & (steps.command[:, 1:] == 0.0).all(axis=1)
    found = {name: float(speed[movement == name].max()) for name in movements}
    if backward.sum() >= FEWEST:
        found[BACKWARD] = float(speed[backward].max())
    return found


def _require_enough(
    steps: Footsteps, controller: ControllerIdentity, movements: tuple[str, ...]
) -> None:
    """Refuse records from which a movement cannot be learned, or with nothing to hold out."""
    unknown = [name for name in movements if name not in MOVEMENTS]
    if unknown or not movements:
        raise InputError(
            f"there is no movement '{', '.join(unknown)}': give some of {', '.join(MOVEMENTS)}"
        )
    movement = movement_of(steps.command)
    for pair, name in enumerate(controller.pair_names):
        counts = {
            each: int(((steps.pair == pair) & (movement == each)).sum()) for each in movements
        }
        few = {each: count for each, count in counts.items() if count < FEWEST}
        if few:
            found = ", ".join(f"{count} {each}" for each, count in few.items())
            raise InputError(
                f"too few footsteps of {name}: {found}; each movement needs {FEWEST} of each pair:"
                " collect more, or leave the movement out (--movements)"
            )
    if len(np.unique(steps.run)) < 2:
        raise InputError(
            "all footsteps are of one run: models are judged on runs held out; add one"
        )
