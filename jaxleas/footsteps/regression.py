"""Three ways to predict displacements: least squares, a table of means, a small network."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int

Predict = Callable[[Float[np.ndarray, "M P"]], Float[np.ndarray, "M L"]]
Fit = Callable[[Float[np.ndarray, "N P"], Float[np.ndarray, "N L"]], Predict]
"""From predictors and labels to a function from predictors to labels."""
COMMAND = slice(0, 3)
"""Columns of the predictors that hold the command."""
_SPREAD = 1e-7
"""A predictor that varies by less than this is constant: nothing can be learned from it."""

_RANK = 1e-13
"""Directions of predictors with less than this share of the variance count as not seen."""


def least_squares(
    predictors: Float[np.ndarray, "N P"], labels: Float[np.ndarray, "N L"]
) -> Float[np.ndarray, "P+1 L"]:
    """Return the weights of a linear model, the intercept last.

    Predictors that do not vary get the weight 0, so that a movement that was never commanded
    takes no share of the intercept.
    """
    centre = np.concatenate([predictors.mean(axis=0), labels.mean(axis=0)])
    return _solved(
        _moments(np.column_stack([predictors, labels]) - centre), centre, labels.shape[1]
    )


def linear_out_of_fold(
    predictors: Float[np.ndarray, "N P"],
    labels: Float[np.ndarray, "N L"],
    fold: Int[np.ndarray, " N"],
) -> Float[np.ndarray, "N L"]:
    """Return what `out_of_fold` with linear models does, at the price of one pass over the rows.

    The sums of products of a fold are taken from those of all rows.
    """
    centre = np.concatenate([predictors.mean(axis=0), labels.mean(axis=0)])
    centred = np.column_stack([predictors, labels]) - centre
    members = [np.flatnonzero(fold == number) for number in np.unique(fold)]
    moments = [_moments(centred[each]) for each in members]
    total = sum(moments[1:], start=moments[0])
    predicted = np.empty_like(labels)
    for each, own in zip(members, moments, strict=True):
        weights = _solved(total - own, centre, labels.shape[1])
        predicted[each] = predictors[each] @ weights[:-1] + weights[-1]
    return predicted


def _moments(rows: Float[np.ndarray, "N K"]) -> Float[np.ndarray, "K+1 K+1"]:
    """Return the sums of products of columns, and of columns and 1."""
    with_one = np.column_stack([rows, np.ones(len(rows))])
    # Not by BLAS: on narrow matrices its threads wait for each other longer than they compute.
    return np.einsum("ni,nj->ij", with_one, with_one)


def _solved(
    moments: Float[np.ndarray, "K+1 K+1"], centre: Float[np.ndarray, " K"], labels: int
) -> Float[np.ndarray, "P+1 L"]:
    """Return the weights that least squares gives for sums of products, by normal equations.

    Args:
        moments: sums of products of predictors, labels and 1, all but the 1 less `centre`.
        centre: what was taken from predictors and labels.
        labels: number of labels.
    """
    inputs = len(centre) - labels
    mean = moments[:-1, -1] / moments[-1, -1]
    covariance = moments[:-1, :-1] / moments[-1, -1] - mean[:, None] * mean[None]
    spread = np.sqrt(np.maximum(np.diag(covariance)[:inputs], 0.0))
    varies = np.flatnonzero(spread > _SPREAD)
    scale = spread[varies]
    square = covariance[np.ix_(varies, varies)] / (scale[:, None] * scale[None])
    aims = covariance[varies, inputs:] / scale[:, None]
    weights = np.zeros((inputs + 1, labels))
    weights[varies] = np.linalg.lstsq(square, aims, rcond=_RANK)[0] / scale[:, None]
    mean = mean + centre
    weights[-1] = mean[inputs:] - mean[:inputs] @ weights[:-1]
    return weights


def fit_linear(predictors: Float[np.ndarray, "N P"], labels: Float[np.ndarray, "N L"]) -> Predict:
    """Return the prediction of a linear model."""
    weights = least_squares(predictors, labels)
    return lambda given: given @ weights[:-1] + weights[-1]


def fit_table(predictors: Float[np.ndarray, "N P"], labels: Float[np.ndarray, "N L"]) -> Predict:
    """Return the prediction of a table: the mean displacement under each command.

    The thesis names it as the simplest model (section 4.1). A command that the table lacks takes
    the entry of the nearest one.
    """
    commands, index = np.unique(np.round(predictors[:, COMMAND], 6), axis=0, return_inverse=True)
    index = index.reshape(-1)
    count = np.bincount(index)[:, None]
    sums = np.zeros((len(commands), labels.shape[1]))
    np.add.at(sums, index, labels)
    means = sums / count

    def predict(given: Float[np.ndarray, "M P"]) -> Float[np.ndarray, "M L"]:
        asked, back = np.unique(np.round(given[:, COMMAND], 6), axis=0, return_inverse=True)
        apart = np.linalg.norm(asked[:, None] - commands[None], axis=-1)
        return means[apart.argmin(axis=1)][back.reshape(-1)]

    return predict


def out_of_fold(
    predictors: Float[np.ndarray, "N P"],
    labels: Float[np.ndarray, "N L"],
    fold: Int[np.ndarray, " N"],
    fit: Fit,
) -> Float[np.ndarray, "N L"]:
    """Return the prediction of each row by a model that did not see its fold."""
    predicted = np.empty_like(labels)
    for number in np.unique(fold):
        held_out = fold == number
        predict = fit(predictors[~held_out], labels[~held_out])
        predicted[held_out] = predict(predictors[held_out])
    return predicted
