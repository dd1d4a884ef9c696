"""Verdicts by their constructors, and the causes for which planners stop."""

from dataclasses import asdict
from typing import get_args

import pytest

from jaxleas.distillation.report_data import most_frequent
from jaxleas.labels.verdict import verdict_from_json, verdict_to_json
from jaxleas.types import CAUSES, Cause, InputError, PathProgress, PlannerMeasures, Verdict
from jaxleas.types.verdict import UNDECIDED_CAUSES

WHOLE = PathProgress(path=3, length=30, last_index=29, reached=1.0, steps=4, mean_step=0.2)
PART = PathProgress(path=4, length=30, last_index=14, reached=0.5, steps=2, mean_step=0.2)
NUMBERS = PlannerMeasures(repositions=1, least_robustness=5.0)


def test_a_success_has_no_cause() -> None:
    verdict = Verdict.succeeded(WHOLE, 0.1, NUMBERS)
    assert (verdict.decided, verdict.success, verdict.cause, verdict.reason) == (
        True,
        True,
        None,
        "",
    )
    assert (verdict.path, verdict.last_index, verdict.seconds) == (3, 29, 0.1)
    assert (verdict.repositions, verdict.least_robustness, verdict.combinations) == (1, 5.0, None)


@pytest.mark.parametrize("cause", get_args(Cause))
def test_a_stop_is_a_failure_unless_its_cause_says_nothing_of_the_path(cause) -> None:
    verdict = Verdict.stopped(PART, cause, "it stopped", 0.1, NUMBERS)
    assert not verdict.success
    assert verdict.decided == (cause not in ("time_limit", "planner_failed"))
    assert (verdict.cause, verdict.reason, verdict.reached) == (cause, "it stopped", 0.5)
    assert verdict_from_json(verdict_to_json(verdict), "here") == verdict
    assert CAUSES[cause]


def test_every_cause_is_described() -> None:
    assert set(CAUSES) == set(get_args(Cause))
    assert set(UNDECIDED_CAUSES) < set(CAUSES)


def test_files_from_before_causes_open_and_others_are_refused() -> None:
    verdict = Verdict.stopped(PART, "collision", "it stopped", 0.1)
    before = asdict(verdict)
    del before["cause"]
    assert verdict_from_json(before, "here").cause is None
    with pytest.raises(InputError, match="here is no verdict: cause"):
        verdict_from_json({**before, "cause": "bad luck"}, "here")
    del before["steps"]
    with pytest.raises(InputError, match="here is no verdict: it needs the keys"):
        verdict_from_json(before, "here")


def test_failures_are_counted_by_cause_whatever_their_sentences_say() -> None:
    def stop(cause: Cause, reason: str) -> Verdict:
        return Verdict.stopped(PART, cause, reason, 0.1)

    unknown = Verdict(**{**asdict(stop("other", "a sentence of before")), "cause": None})
    found = most_frequent(
        [
            stop("collision", "the trunk touches"),
            stop("infeasible", "step 3 (LF onto 'a')"),
            unknown,
            stop("infeasible", "another sentence"),
            stop("other", "bad luck"),
        ]
    )
    assert [(each.count, each.cause) for each in found] == [
        (2, CAUSES["infeasible"]),
        (2, CAUSES["other"]),
        (1, CAUSES["collision"]),
    ]
    assert found[0].example == "step 3 (LF onto 'a')"
