"""The quality of a fitted surrogate on terrain it never saw: by stretch, and by guide path."""

from dataclasses import asdict
from typing import Any

import numpy as np

from jaxleas.surrogates.calibration import (
    area_under_curve,
    best_threshold,
    calibration_curve,
    confusion,
    expected_calibration_error,
    log_loss,
)
from jaxleas.surrogates.labelled_paths import LabelledPaths

Scored = tuple[np.ndarray, LabelledPaths]  # calibrated logits of the hazard, and their paths


def report_on(calibration: Scored, judged: Scored, learned: LabelledPaths) -> dict[str, Any]:
    """Return the report as plain JSON values.

    A *stretch* leads from one kept configuration to the next. The predicted probability that a
    guide path fails is that of a failure in any of its stretches. Thresholds are chosen on the
    calibration terrains; everything is counted on the terrains for judgement.
    """
    return {
        "guides": {"learned": len(learned), "calibration": len(calibration[1])},
        "terrains": {
            "learned": len(np.unique(learned.map_index)),
            "calibration": len(np.unique(calibration[1].map_index)),
            "judged": len(np.unique(judged[1].map_index)),
        },
        "stretch": _compare(_stretches(*calibration), _stretches(*judged)),
        "guide": _compare(_guides(*calibration), _guides(*judged)),
    }


def _stretches(logit: np.ndarray, paths: LabelledPaths) -> tuple[np.ndarray, np.ndarray]:
    known = paths.is_known
    return _sigmoid(logit[known]), paths.failed[known]


def _guides(logit: np.ndarray, paths: LabelledPaths) -> tuple[np.ndarray, np.ndarray]:
    return failure_along(logit, paths), paths.failed_at >= 0


def failure_along(logit: np.ndarray, paths: LabelledPaths) -> np.ndarray:
    """Return the probability of a failure somewhere along each path: 1 - prod(1 - hazard)."""
    there = np.arange(logit.shape[1])[None] < paths.kept[:, None]
    passing = -np.logaddexp(0.0, logit)  # log(1 - hazard)
    return 1.0 - np.exp(np.sum(passing * there, axis=1))


def _compare(
    calibration: tuple[np.ndarray, np.ndarray], judged: tuple[np.ndarray, np.ndarray]
) -> dict[str, Any]:
    probability, failed = judged
    curve = calibration_curve(probability, failed)
    table = confusion(probability, failed, best_threshold(*calibration))
    share = np.full(len(failed), np.mean(failed))
    return {
        "count": len(failed),
        "failed": int(np.sum(failed)),
        "balanced_accuracy": table.balanced_accuracy,
        "area_under_curve": area_under_curve(probability, failed),
        "calibration_error": expected_calibration_error(curve),
        "log_loss": log_loss(probability, failed),
        "log_loss_of_the_share": log_loss(share, failed),
        "confusion": asdict(table),
        "curve": curve.tolist(),
    }


def _sigmoid(logit: np.ndarray) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-logit))
