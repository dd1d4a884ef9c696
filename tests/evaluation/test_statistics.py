import pytest

from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.types import InputError


@pytest.mark.parametrize("count", [1, 7, 100, 1000])
def test_the_interval_holds_the_fraction_and_mirrors(count):
    for successes in {0, 1, count // 3, count}:
        low, high = wilson_interval(successes, count)
        assert 0.0 <= low <= successes / count <= high <= 1.0
        mirrored = wilson_interval(count - successes, count)
        assert mirrored == pytest.approx((1.0 - high, 1.0 - low), abs=1e-12)


def test_more_trials_of_one_fraction_narrow_it():
    widths = [high - low for low, high in (wilson_interval(n // 2, n) for n in (10, 100, 1000))]
    assert widths[0] > widths[1] > widths[2]


@pytest.mark.parametrize(
    ("successes", "count", "low", "high"),
    [
        (0, 10, 0.0, 0.2775),  # Brown, Cai and DasGupta (2001); R's prop.test(correct = FALSE)
        (5, 10, 0.2366, 0.7634),
        (81, 263, 0.2553, 0.3662),  # Newcombe (1998), table I
        (15, 148, 0.0624, 0.1605),
        (1, 29, 0.0061, 0.1718),
        (1000, 1000, 0.99617, 1.0),
    ],
)
def test_known_intervals(successes, count, low, high):
    assert wilson_interval(successes, count) == pytest.approx((low, high), abs=1e-4)


@pytest.mark.parametrize(("successes", "count"), [(0, 0), (-1, 5), (6, 5)])
def test_no_fraction_is_refused(successes, count):
    with pytest.raises(InputError, match="no fraction"):
        wilson_interval(successes, count)
