"""Calibration: how well predicted probabilities match verdicts that were held out."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float
from scipy.optimize import minimize

BINS = 10
_SMALLEST = 1e-7  # probabilities are kept this far from 0 and 1


@dataclass(frozen=True)
class Confusion:
    """Numbers of verdicts by prediction, at one threshold.

    Attributes:
        threshold: probability above which a failure is predicted.
        failed_foreseen: number of failures of the planner that were predicted.
        failed_unforeseen: number of failures of the planner that were not predicted.
        passed_foreseen: number of successes of the planner that were predicted.
        passed_unforeseen: number of successes of the planner where failure was predicted.
    """

    threshold: float
    failed_foreseen: int
    failed_unforeseen: int
    passed_foreseen: int
    passed_unforeseen: int

    @property
    def balanced_accuracy(self) -> float:
        """Mean of the shares of failures and of passes foreseen; NaN without failures or passes."""
        failed = self.failed_foreseen + self.failed_unforeseen
        passed = self.passed_foreseen + self.passed_unforeseen
        if not failed or not passed:
            return float("nan")
        return 0.5 * (self.failed_foreseen / failed + self.passed_foreseen / passed)


def platt(logit: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"]) -> tuple[float, float]:
    """Return the scale and shift of the logit with the greatest likelihood (Platt 1999).

    The targets are Platt's: (n_failed + 1) / (n_failed + 2) and 1 / (n_passed + 2), so that a few
    verdicts never give certainty.
    """
    count = int(np.sum(failed))
    target = np.where(failed, (count + 1.0) / (count + 2.0), 1.0 / (len(failed) - count + 2.0))

    def loss(parameters: np.ndarray) -> tuple[float, np.ndarray]:
        scale, shift = parameters
        moved = scale * logit + shift
        # log(1 + e^x) - t x, and its derivative
        difference = 1.0 / (1.0 + np.exp(-np.clip(moved, -50.0, 50.0))) - target
        value = np.mean(np.logaddexp(0.0, moved) - target * moved)
        return float(value), np.array([np.mean(difference * logit), np.mean(difference)])

    found = minimize(loss, np.array([1.0, 0.0]), jac=True, method="BFGS")
    scale, shift = found.x
    # A scale below zero would reverse the network's order: then its logits are of no use.
    return (float(scale), float(shift)) if scale > 0.0 else (0.0, _logit(count / len(failed)))


def best_threshold(probability: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"]) -> float:
    """Return the threshold of greatest balanced accuracy."""
    order = np.argsort(-probability)
    hit = np.cumsum(failed[order]) / max(1, np.sum(failed))
    missed = np.cumsum(~failed[order]) / max(1, np.sum(~failed))
    best = int(np.argmax(hit - missed))
    last = probability[order[best]]
    following = probability[order[best + 1]] if best + 1 < len(order) else 0.0
    return float(0.5 * (last + following))


def confusion(
    probability: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"], threshold: float
) -> Confusion:
    """Count verdicts against predictions."""
    foreseen = probability > threshold
    return Confusion(
        threshold=threshold,
        failed_foreseen=int(np.sum(foreseen & failed)),
        failed_unforeseen=int(np.sum(~foreseen & failed)),
        passed_foreseen=int(np.sum(~foreseen & ~failed)),
        passed_unforeseen=int(np.sum(foreseen & ~failed)),
    )


def calibration_curve(
    probability: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"], bins: int = BINS
) -> Float[np.ndarray, "bins 3"]:
    """Return mean predicted probability, share of failures and count, in bins of equal count."""
    order = np.argsort(probability, kind="stable")
    rows = [
        (np.mean(probability[part]), np.mean(failed[part]), len(part))
        for part in np.array_split(order, bins)
        if len(part)
    ]
    return np.array(rows).reshape(-1, 3)


def expected_calibration_error(curve: Float[np.ndarray, "bins 3"]) -> float:
    """Return the mean error of a curve's probabilities, weighted by count (Naeini 2015)."""
    return float(np.average(np.abs(curve[:, 0] - curve[:, 1]), weights=curve[:, 2]))


def area_under_curve(probability: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"]) -> float:
    """Return the probability that a failure is ranked above a pass (Mann-Whitney), or NaN."""
    from scipy.stats import rankdata

    count = int(np.sum(failed))
    if count in (0, len(failed)):
        return float("nan")
    ranks = rankdata(probability)[failed].sum()
    return float((ranks - count * (count + 1) / 2) / (count * (len(failed) - count)))


def log_loss(probability: Float[np.ndarray, " n"], failed: Bool[np.ndarray, " n"]) -> float:
    """Return the mean negative log-likelihood of the verdicts [nats]."""
    sure = np.clip(probability, _SMALLEST, 1.0 - _SMALLEST)
    return float(-np.mean(np.where(failed, np.log(sure), np.log1p(-sure))))


def _logit(probability: float) -> float:
    sure = min(max(probability, _SMALLEST), 1.0 - _SMALLEST)
    return float(np.log(sure / (1.0 - sure)))
