"""The policy that is shipped does what the README says of it, on terrain nobody has looked at."""

from pathlib import Path

import pytest

from jaxleas.evaluation.examination import examine, load_candidate
from jaxleas.evaluation.suites import make_suite

PRETRAINED = Path(__file__).resolve().parents[2] / "pretrained" / "leas_p1.npz"


@pytest.mark.slow
def test_the_pretrained_policy_crosses_and_stops_where_it_cannot():
    candidate = load_candidate(PRETRAINED)
    for name in ("transitions", "dead_end"):
        # Seed 7 of the held-out range: neither trained on nor in any table.
        suite = make_suite(name, 60, seed=7, held_out=True)
        for cell in examine(candidate, suite, baseline=False).cells:
            assert cell.invalid == 0.0, (cell.name, cell.yaw)
            if name == "transitions":
                assert cell.reached == 1.0, (cell.name, cell.yaw)
