import json
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.quadruped.public import FORWARD, rows_of, simulated
from jaxleas.footsteps import FitSettings, fit_motion_models, mean_absolute_error, network
from jaxleas.footsteps.features import predictors_of
from jaxleas.footsteps.folds import folds_of
from jaxleas.footsteps.judging import linear_scores, rival_scores
from jaxleas.footsteps.pair_footsteps import PairFootsteps
from jaxleas.footsteps.regression import (
    fit_linear,
    fit_table,
    least_squares,
    linear_out_of_fold,
    out_of_fold,
)
from jaxleas.types import InputError
from tests.footsteps.made import elsewhere, walked


@pytest.fixture(scope="module")
def made():
    return walked(runs=20, steps=60, noise=0.002)


@pytest.fixture(scope="module")
def fitted(made):
    return fit_motion_models(made, FitSettings(network=False))


@pytest.fixture(scope="session")
def of_public(public):
    return fit_motion_models(public, FORWARD)


def the_score(scores, target, feet="", split="run", predictors="C4", **more):
    wanted = {"target": target, "feet": feet, "split": split, "predictors": predictors}
    wanted |= {"model": "linear", "movement": "all", **more}
    found = [each for each in scores if wanted.items() <= vars(each).items()]
    assert len(found) == 1, found
    return found[0]


def test_weights_are_those_of_numpys_least_squares():
    generator = np.random.default_rng(0)
    predictors = generator.normal(size=(300, 6)) * [1, 10, 0.01, 1, 1, 0] + 3
    labels = generator.normal(size=(300, 2)) + predictors[:, :2]
    with_one = np.column_stack([predictors[:, :5], np.ones(300)])
    expected = np.linalg.lstsq(with_one, labels, rcond=None)[0]
    weights = least_squares(predictors, labels)
    np.testing.assert_allclose(weights[[0, 1, 2, 3, 4, 6]], expected, rtol=1e-8, atol=1e-10)
    assert (weights[5] == 0).all()  # a predictor that does not vary


def test_folds_solved_together_are_folds_solved_one_by_one(made):
    predictors = predictors_of(made.footsteps)
    labels = made.footsteps.com_after[:, :2]
    fold = folds_of("run", made.footsteps.run, 0)
    np.testing.assert_allclose(
        linear_out_of_fold(predictors, labels, fold),
        out_of_fold(predictors, labels, fold, fit_linear),
        atol=1e-8,
    )


def test_a_run_is_in_one_fold():
    run = np.repeat(np.arange(40), 7)
    by_run = folds_of("run", run, 0)
    assert all(len(set(by_run[run == each])) == 1 for each in range(40))
    assert np.bincount(by_run).tolist() == [28] * 10
    at_random = folds_of("random", run, 0)
    assert len({*at_random[run == 0], *at_random[run == 1], *at_random[run == 2]}) > 3


def test_what_is_predicted_does_not_depend_on_where_the_robot_is(made, fitted):
    moved = replace(made, footsteps=elsewhere(made.footsteps, 2.3, np.array([40.0, -7.0, 1.5])))
    again = fit_motion_models(moved, FitSettings(network=False))
    for first, second in zip(fitted.model.weights, again.model.weights, strict=True):
        np.testing.assert_allclose(first, second, atol=1e-8)
    for first, second in zip(fitted.scores, again.scores, strict=True):
        assert first.error == pytest.approx(second.error, rel=1e-6)


def test_a_linear_walker_is_learned_exactly():
    without_noise = walked(runs=20, steps=60)
    fitted = fit_motion_models(without_noise, FitSettings(network=False))
    assert fitted.landing["relative"] < 1e-9
    assert fitted.model.errors.com["0.99"] < 1e-9
    assert fitted.model.feet == "relative"
    assert fitted.landing["absolute"] > 1e-4  # a turn makes it curved


def test_noise_sets_the_quantiles_of_landings(fitted):
    """Each coordinate of pose and foot has noise of 2 mm, seen from the robot's new frame."""
    assert fitted.model.feet == "relative"
    noise = np.random.default_rng(1).normal(size=(100_000, 4)) * 0.002
    wanted = np.quantile(np.hypot(noise[:, 0] + noise[:, 2], noise[:, 1] + noise[:, 3]), 0.95)
    assert fitted.model.errors.landing["0.95"] == pytest.approx(wanted, rel=0.1)


def test_the_table_of_means_answers_with_the_nearest_command():
    commands = np.array([[0.1, 0, 0], [0.1, 0, 0], [0.5, 0, 0]])
    predict = fit_table(commands, np.array([[1.0], [3.0], [7.0]]))
    assert predict(np.array([[0.1, 0, 0], [0.45, 0, 0], [0.2, 0, 0]])).tolist() == [[2], [7], [2]]


@pytest.mark.slow
def test_the_network_learns_what_is_linear(made):
    part = PairFootsteps.of(made.footsteps, 0, made.controller, seed=0)
    scores = [*linear_scores(part), *rival_scores(part, network.fit_network)]
    linear = the_score(scores, "com x")
    of_network = the_score(scores, "com x", model="network")
    table = the_score(scores, "com x", model="table", predictors="C1")
    assert of_network.error < 1.5 * linear.error < table.error


def test_a_network_is_fitted_to_each_pair_unless_refused(made, fitted, monkeypatch):
    monkeypatch.setattr(network, "UPDATES", 2)  # what it learns is another test's
    network._train.clear_cache()
    scores = fit_motion_models(made, FitSettings()).scores
    network._train.clear_cache()
    assert {each.pair for each in scores if each.model == "network"} == {"LF/RH", "RF/LH"}
    assert not [each for each in fitted.scores if each.model == "network"]


def test_too_few_footsteps_of_a_movement_are_counted(made):
    steps = made.footsteps
    sparse = steps.at((steps.movement != "left") | (np.cumsum(steps.movement == "left") < 100))
    with pytest.raises(InputError, match=r"of LF/RH: \d\d left; each movement needs 100"):
        fit_motion_models(replace(made, footsteps=sparse), FitSettings(network=False))
    without_left = FitSettings(movements=("forward", "right"), network=False)
    model = fit_motion_models(replace(made, footsteps=sparse), without_left).model
    assert set(model.fastest) == {"forward", "right"}
    assert (model.commands()[:, 2] == 0).all()
    assert len(model.commands()) == 19
    with pytest.raises(InputError, match="no movement 'sideways'"):
        fit_motion_models(made, FitSettings(movements=("sideways",)))
    one_run = replace(made, footsteps=replace(steps, run=np.zeros_like(steps.run)))
    with pytest.raises(InputError, match="all footsteps are of one run"):
        fit_motion_models(one_run, FitSettings(network=False))


def test_public_footsteps_give_the_published_scores(of_public):
    best = the_score(of_public.scores, "com x", pair="FL/RR")
    assert best.r2 == pytest.approx(98.8, abs=0.1)
    assert best.error == pytest.approx(6.6, abs=0.2)
    worse = {row.name: row.runs[0] for row in rows_of(of_public.scores)}
    assert worse["public_com_x_c4_r2"] == pytest.approx(98.8, abs=0.1)
    assert worse["public_com_x_c4_error"] == pytest.approx(6.6, abs=0.2)
    assert worse["public_com_x_c4_r2"] <= best.r2


def test_a_folder_without_the_public_footsteps_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"holds no sim_footsteps.npz: give the folder of the"):
        simulated(tmp_path)


@pytest.mark.parametrize("split", ["run", "rand"])
def test_public_footsteps_give_the_reference_fits(shared, of_public, split):
    text = (shared / "data/quadruped/reference_fits.json").read_text()
    rows = [row for row in json.loads(text)["rows"] if row["split"] == split]
    assert len(rows) == 14
    ours = "random" if split == "rand" else "run"
    # Not published: which footsteps a random fold holds, and to which run a change belongs.
    within = {"run": (0.2, 0.015), "rand": (0.25, 0.1)}[split]
    for row in rows:
        target = row["target"].replace("CoM_th", "com yaw").replace("CoM", "com").replace("_", " ")
        feet = "" if target.startswith("com") else "absolute"
        for choice in ("C1", "C2", "C3", "C4"):
            score = the_score(of_public.scores, target, feet, ours, choice, pair=row["pair"])
            assert score.r2 == pytest.approx(row[f"{choice}_R2_percent"], abs=within[0]), row
            assert score.error == pytest.approx(row[f"{choice}_MAE_mm_or_mrad"], abs=within[1])
        if feet:
            score = the_score(of_public.scores, target, "relative", ours, pair=row["pair"])
            assert score.r2 == pytest.approx(row["rel_R2_percent"], abs=within[0])
            assert score.error == pytest.approx(row["rel_MAE_mm_or_mrad"], abs=within[1])


TABLE_5_10 = {
    "scenario1_run1__6d68aae4": (2.53, 1.18),
    "scenario1_run2__180a1a9f": (2.43, 1.19),
    "scenario1_run3__8b5368a3": (2.62, 1.34),
    "scenario3_run1__ae02720d": (2.92, 1.50),
    "scenario3_run2__783558b8": (3.13, 1.71),
    "scenario3_run3__4c3407ae": (3.24, 1.52),
}


@pytest.mark.parametrize("run", TABLE_5_10)
def test_published_logs_give_the_printed_errors(shared, run):
    log = np.load(shared / "data/quadruped/thesis_planner_logs.npz")[run]
    centimetres = 100 * mean_absolute_error(log[:, 0:2], log[:, 2:4])
    np.testing.assert_allclose(centimetres, TABLE_5_10[run], atol=0.0101)
