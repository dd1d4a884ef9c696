"""How well predictions agree with what happened: R2 and mean absolute error."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True)
class Score:
    """The agreement of one model's predictions with one displacement.

    Attributes:
        target: what is predicted, such as "com x" or "LF y".
        pair: names of the feet that swing, such as "LF/RH".
        model: what predicts: "linear", "table" or "network".
        predictors: what the model sees, "C1" to "C4".
        feet: how the foot is predicted: "absolute" (displacement over the ground), "relative"
            (place in the robot's next frame), or "" for the centre of mass.
        split: "run" or "random": what the model has not seen.
        movement: movement that the score is of, or "all".
        count: number of footsteps.
        r2: share of the variance that is predicted [%]; None where nothing varies.
        error: mean absolute error [mm], for a yaw [mrad].
    """

    target: str
    pair: str
    model: str
    predictors: str
    feet: str
    split: str
    movement: str
    count: int
    r2: float | None
    error: float


def r2_percent(truth: Float[np.ndarray, " N"], predicted: Float[np.ndarray, " N"]) -> float | None:
    """Return the share of the variance of the truth that is predicted [%].

    The thesis exchanges truth and prediction, which flatters a weak model less: 0.1 point at 97 %.
    """
    total = ((truth - truth.mean()) ** 2).sum()
    if total < 1e-18 * len(truth):
        return None
    return float(100 * (1 - ((truth - predicted) ** 2).sum() / total))


def mean_absolute_error(
    truth: Float[np.ndarray, "N *rest"], predicted: Float[np.ndarray, "N *rest"]
) -> Float[np.ndarray, "*rest"]:
    """Return the mean over the first axis of the absolute differences, in the unit given."""
    return np.abs(truth - predicted).mean(axis=0)
