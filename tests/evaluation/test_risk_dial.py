"""The risk dial: refusing while walking is what the sweep says it would be."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas import cli
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.evaluation.exact_answers import Judged
from jaxleas.evaluation.judge import roll_out_cell, summarise
from jaxleas.evaluation.refusal import load_refusal
from jaxleas.evaluation.risk_dial import Guides, as_json, foresee, join, sweep
from jaxleas.evaluation.starts import draw_starts, make_grounds
from jaxleas.guide.leas import leas
from jaxleas.reports.risk_dial import draw_dial
from jaxleas.surrogates import SurrogateForesight, write_surrogate
from jaxleas.surrogates.features import MOTION_FEATURES
from jaxleas.types import InputError

from ..guide.walkers import homing_policy
from ..surrogates.test_foresight import surrogate
from ..surrogates.walkers import identity


@pytest.fixture(scope="module")
def doubtful():
    """A surrogate of random opinions: a guide path of a few metres may well fail."""
    random = surrogate(seed=3)
    weights = random.weights.replace(head_bias=jnp.float32(-4.0))
    return random.replace(weights=weights)


@pytest.mark.slow
def test_refused_while_walking_is_what_lies_below_the_threshold_in_the_end(flat_suite, doubtful):
    policy = homing_policy()
    cell, steps = flat_suite.cells[0], 300
    grounds = make_grounds([cell])
    free = SteeringEnv(policy.config)
    starts = draw_starts(free, grounds, cell, 0)
    walked = roll_out_cell(free, grounds, leas(free, policy), starts, steps)
    assert walked.reached.sum() >= 6
    assert walked.refused is None
    judged = Judged(walked, (None,) * cell.starts)
    guides = foresee(free, grounds.atlas, judged, doubtful, free.config.limits.time_step)
    assert np.ptp(guides.survival[guides.reached]) > 0.01
    threshold = float(np.median(guides.survival[guides.reached]))
    env = SteeringEnv(policy.config, foresight=SurrogateForesight(doubtful, threshold))
    careful = roll_out_cell(env, grounds, leas(env, policy), starts, steps)
    expected = guides.reached & (guides.survival >= threshold)
    sure = np.abs(guides.survival - threshold) > 1e-5  # float32 walks, float64 sums
    np.testing.assert_array_equal(careful.reached[sure], expected[sure])
    assert careful.refused is not None
    np.testing.assert_array_equal(careful.refused[sure], (guides.reached & ~expected)[sure])
    for row in np.flatnonzero(careful.refused):
        assert careful.end[row] < walked.end[row]
        np.testing.assert_allclose(
            careful.path(row), walked.position[row, : careful.end[row] + 1], atol=1e-6
        )
    result = summarise(cell, "leas_p1", careful, 0.2)
    assert result.refused == pytest.approx(careful.refused.mean(), abs=1e-6)
    assert result.stopped >= result.refused


def some_guides(count=400, seed=0):
    """Guide paths whose planner succeeds with just the probability foreseen."""
    generator = np.random.default_rng(seed)
    survival = generator.uniform(0.5, 1.0, count)
    reached = generator.random(count) < 0.9
    planned = reached & (generator.random(count) < survival)
    return Guides(reached, planned, np.where(reached, survival, 0.0), np.full(count, 0.1))


def test_a_threshold_counts_what_a_loop_counts():
    guides = some_guides()
    for setting in sweep(guides, [0.0, 0.7, 0.9]):
        tried = good = 0
        for row in range(400):
            if guides.reached[row] and guides.survival[row] >= setting.threshold:
                tried += 1
                good += bool(guides.planned[row])
        assert setting.attempted == tried / 400
        assert setting.planned == good / 400
        assert setting.success == good / tried
        assert setting.low < setting.success < setting.high
        assert setting.speed == pytest.approx(0.1)


def test_a_higher_threshold_buys_success_with_starts_refused():
    careless, careful = sweep(join([some_guides(), some_guides(seed=1)]), [0.0, 0.9])
    assert careful.success > careless.success + 0.1
    assert careful.attempted < careless.attempted
    (nothing,) = sweep(some_guides(), [1.0])
    assert (nothing.attempted, nothing.success, nothing.speed) == (0.0, None, None)
    curve = as_json([careless, careful, nothing])
    assert draw_dial({"all": curve}, "title").startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (["--threshold", "0.5"], "--threshold 0.5 needs a --surrogate"),
        (["--surrogate", "S"], "needs a --threshold"),
        (["--surrogate", "S", "--threshold", "1.5"], "--threshold is 1.5"),
        (["--surrogate", "nowhere.npz", "--threshold", "0.5"], r"nowhere\.npz"),
        (
            ["--surrogate", "S", "--threshold", "0.5", "--planners", "mip"],
            "stands in for the sampling planner, but mip will judge",
        ),
        (["--surrogate", "O", "--threshold", "0.5"], "observation = icra81, not thesis144"),
    ],
)
def test_what_cannot_be_is_refused_with_one_sentence(run, tmp_path, doubtful, given, sentence):
    write_surrogate(tmp_path / "S.npz", doubtful)
    else_where = identity(observation="icra81")
    encoder = jnp.zeros((len(else_where.near) + MOTION_FEATURES, 8))
    weights = doubtful.weights.replace(encoder=encoder)
    other = doubtful.replace(weights=weights, identity=else_where)
    write_surrogate(tmp_path / "O.npz", other)
    words = [str(tmp_path / f"{each}.npz") if each in "SO" else each for each in given]
    with pytest.raises(InputError, match=sentence):
        cli.run(["evaluate", str(run), "--suite", "hole", "--starts", "4", *words])
    assert not (run / "evaluation").exists()


def test_a_refusal_says_whose_it_is(tmp_path, doubtful):
    write_surrogate(tmp_path / "s.npz", doubtful)
    refusal = load_refusal(tmp_path / "s.npz", 0.25)
    assert refusal is not None
    said = refusal.describe()
    assert (said["planner"], said["threshold"], len(said["surrogate"])) == ("sampling", 0.25, 64)
    assert load_refusal(None, None) is None
    assert jax.tree.leaves(refusal.surrogate.weights)
