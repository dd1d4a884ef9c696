"""The thesis's tables with our numbers: the page is that of the results, and lacks copy errors."""

import pytest

from benchmarks.quadruped.tables.__main__ import COURSES, OUT, PAGE
from benchmarks.quadruped.tables.page import page_of
from benchmarks.quadruped.tables.printed import SCENARIOS
from jaxleas.files import read_json


def test_the_page_is_made_of_the_results():
    assert PAGE.read_text(encoding="utf-8") == page_of(read_json(OUT))


def test_every_course_has_all_that_is_shown():
    found = read_json(OUT)["courses"]
    assert tuple(found) == COURSES
    for scenario in SCENARIOS:
        here = found[scenario.course]
        assert list(here["blind"]) == list(scenario.blind)
        for runs in (here["planned"], *here["blind"].values()):
            assert len(runs) == here["starts"]
            for run in runs:
                assert all(b <= n for b, n in zip(run["unsafe"], run["landings"], strict=True))


def test_what_the_thesis_copied_by_mistake_is_left_out():
    by_number = {each.number: each for each in SCENARIOS}
    assert not by_number["2.2"].unsafe
    assert not by_number["3.1"].nearest
    # Table 5.10, as the thesis's own logs give it to 0.01 cm.
    assert by_number["1.3"].com_x == pytest.approx((2.92, 3.13, 3.24))
