"""Tables, report and what trials are measured by."""

import csv
import html.parser
import json
import re
from types import SimpleNamespace

import pytest

from jaxleas.files import write_text
from jaxleas.sweeps.border import open_sweep
from jaxleas.sweeps.charts import place_on
from jaxleas.sweeps.config import Dimension, Exact, TimeToSuccess
from jaxleas.sweeps.folder import open_folder
from jaxleas.sweeps.objectives import measure, never
from jaxleas.sweeps.report import report_html
from jaxleas.sweeps.results import TrialResult, best_of, plain_table, write_results
from jaxleas.sweeps.study import read_results
from jaxleas.training.policy import write_policy
from tests.guide.walkers import random_policy
from tests.sweeps.files import write_sweep

SPACE = {
    "ppo.learning_rate": {"low": 1e-4, "high": 1e-2, "log": True},
    "network.hidden": {"choices": [[16], [32, 32]]},
    "ppo.epochs": {"low": 1, "high": 5, "only_when": {"network.hidden": [[16]]}},
}
OBJECTIVES = [{"measure": "held_out"}, {"measure": "steps_to_success", "success": 0.5}]


def rows(run, successes):
    run.mkdir(parents=True)
    lines = [
        {"step": 640 * (n + 1), "seconds": 2.0 * (n + 1), "walk/reward": 0.1}
        | ({} if success is None else {"held_out/reached": success})
        for n, success in enumerate(successes)
    ]
    write_text(run / "metrics.jsonl", "".join(json.dumps(line) + "\n" for line in lines))
    return run


@pytest.mark.parametrize(
    ("successes", "steps", "seconds"),
    [
        ([None, 0.2, None, 0.6, 0.9], 640 * 4, 8.0),
        ([0.5], 640, 2.0),
        # Never: the whole, and the part by which the best fell short of 0.5.
        ([None, 0.2, None, 0.3, 0.1], 10_000 * 1.4, 10.0 * 1.4),
    ],
)
def test_time_to_a_success(tmp_path, successes, steps, seconds):
    run = rows(tmp_path / "run", successes)
    by_steps = TimeToSuccess(measure="steps_to_success", success=0.5)
    by_seconds = TimeToSuccess(measure="seconds_to_success", success=0.5)
    values = measure(run, [by_steps, by_seconds], total_steps=10_000)
    assert values == pytest.approx({"steps_to_50%": steps, "seconds_to_50%": seconds})
    assert never(by_steps, values["steps_to_50%"], 10_000) == (steps > 10_000)


def test_held_out_is_the_success_of_the_policy_that_is_kept(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path))
    run = rows(tmp_path / "run", [0.2, 0.7, None, 0.6])
    assert measure(run, sweep.config.objectives, 2560) == {"held_out": 0.7}


def test_exact_success_is_the_mean_over_the_cells_of_held_out_suites(tmp_path, monkeypatch):
    asked = []

    def judge(env, walkers, suite, planners):
        asked.append((suite.name, [cell.starts for cell in suite.cells], *planners))
        return [SimpleNamespace(planned=share) for share in (0.5, None, 1.0)]

    monkeypatch.setattr("jaxleas.evaluation.exact.judge_exact", judge)
    (tmp_path / "run").mkdir()
    write_policy(tmp_path / "run/policy.npz", random_policy())
    exact = Exact(measure="exact", planner="sl1m", suites=("hole", "wall"), starts=3)
    assert measure(tmp_path / "run", [exact], 1) == {"exact_sl1m": pytest.approx(0.5)}
    assert [(name, planner) for name, _, planner in asked] == [
        ("hole_held_out", "sl1m"),
        ("wall_held_out", "sl1m"),
    ]
    assert all(set(starts) == {3} for _, starts, _ in asked)


def trials() -> list[TrialResult]:
    def done(number, rate, held_out, steps, **params):
        values = {"held_out": held_out, "steps_to_50%": steps}
        params = {"ppo.learning_rate": rate, "network.hidden": [32, 32]} | params
        return TrialResult(number, "done", params, values, {"0": values}, "", 3.0)

    return [
        done(0, 1e-4, 0.5, 5120.0),
        done(1, 1e-3, 0.9, 2560.0, **{"network.hidden": [16], "ppo.epochs": 3}),
        done(2, 1e-2, 0.7, 1280.0),
        TrialResult(3, "failed", {"ppo.learning_rate": 3e-3}, {}, {}, "<numbers> & such", 1.0),
    ]


def test_the_best_are_those_that_nobody_beats(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path, space=SPACE, objectives=OBJECTIVES))
    assert [each.number for each in best_of(trials(), sweep.config.objectives)] == [1, 2]
    assert [each.number for each in best_of(trials(), sweep.config.objectives[:1])] == [1]
    assert best_of(trials()[3:], sweep.config.objectives) == []


def test_results_are_written_read_and_told(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path, space=SPACE, objectives=OBJECTIVES))
    write_results(tmp_path, trials(), sweep)
    assert read_results(tmp_path) == trials()
    with (tmp_path / "results.csv").open() as stream:
        table = list(csv.DictReader(stream))
    assert [row["held_out"] for row in table] == ["0.5", "0.9", "0.7", ""]
    assert table[3]["reason"] == "<numbers> & such"
    lines = plain_table(trials(), sweep).splitlines()
    assert lines[1].split()[:5] == ["1*", "done", "90.0", "%", "2,560"]
    assert [line.split()[0] for line in lines] == ["trial", "1*", "2*", "0", "3"]


class _Reader(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.lines, self.outside = 0, []

    def handle_starttag(self, tag, attrs):
        self.lines += tag == "polyline"
        self.outside += [value for name, value in attrs if name in ("src", "href")]


def test_the_report_stands_alone_and_draws_every_trial(tmp_path):
    sweep = open_sweep(write_sweep(tmp_path, space=SPACE, objectives=OBJECTIVES))
    folder = open_folder(tmp_path / "out", sweep)
    for number in range(3):
        rows(folder.run(number, 0), [0.1, 0.5, 0.4])
    page = report_html(sweep, trials(), {"ppo.learning_rate": 0.8, "network.hidden": 0.2}, folder)
    folder.close()
    reader = _Reader()
    reader.feed(page)
    assert reader.lines == 3 + 3 + 3  # two objectives, three curves
    assert reader.outside == []
    assert "&lt;numbers&gt; &amp; such" in page
    assert "80 %" in page
    for points in re.findall(r'points="([^"]*)"', page):
        for point in points.split():
            x, y = map(float, point.split(","))
            assert 0 <= x <= 960
            assert 0 <= y <= 340


def test_values_lie_where_they_belong_on_their_axis():
    assert place_on(Dimension(low=1e-4, high=1e-2, log=True), 1e-3) == pytest.approx(0.5)
    assert place_on(Dimension(low=0.0, high=4.0), 1.0) == pytest.approx(0.25)
    assert place_on(Dimension(choices=([16], [32, 32], [64])), [64]) == 1.0
    assert place_on(Dimension(low=0.0, high=4.0), None) is None
