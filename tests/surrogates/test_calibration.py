"""Calibration's numbers on cases counted by hand, and laws."""

import numpy as np
import pytest

from jaxleas.surrogates.calibration import (
    area_under_curve,
    best_threshold,
    calibration_curve,
    confusion,
    expected_calibration_error,
    log_loss,
    platt,
)


def draw(scale, shift, count=200_000):
    generator = np.random.default_rng(0)
    logit = generator.normal(size=count)
    failed = generator.random(count) < 1 / (1 + np.exp(-(scale * logit + shift)))
    return logit, failed


def test_platt_finds_scale_and_shift():
    logit, failed = draw(2.0, -3.0)
    scale, shift = platt(logit, failed)
    assert scale == pytest.approx(2.0, abs=0.05)
    assert shift == pytest.approx(-3.0, abs=0.05)


def test_platt_trusts_no_network_that_is_always_wrong():
    logit, failed = draw(2.0, 0.0, 5000)
    scale, shift = platt(-logit, failed)
    assert scale == 0.0
    assert 1 / (1 + np.exp(-shift)) == pytest.approx(np.mean(failed))


def test_true_probabilities_are_calibrated_and_shifted_ones_are_not():
    logit, failed = draw(1.5, -2.0)
    true = 1 / (1 + np.exp(-(1.5 * logit - 2.0)))
    assert expected_calibration_error(calibration_curve(true, failed)) < 0.005
    assert expected_calibration_error(calibration_curve(0.5 * true, failed)) > 0.05
    assert log_loss(true, failed) < log_loss(0.5 * true, failed)


def test_counts_by_hand():
    probability = np.array([0.9, 0.8, 0.3, 0.2, 0.1])
    failed = np.array([True, False, True, False, False])
    table = confusion(probability, failed, 0.25)
    assert (table.failed_foreseen, table.failed_unforeseen) == (2, 0)
    assert (table.passed_foreseen, table.passed_unforeseen) == (2, 1)
    assert table.balanced_accuracy == pytest.approx(0.5 * (1.0 + 2 / 3))
    assert 0.2 < best_threshold(probability, failed) < 0.3
    assert area_under_curve(probability, failed) == pytest.approx(5 / 6)
    assert np.isnan(confusion(probability, failed & False, 0.5).balanced_accuracy)
