"""The report of a distilled run, from its files alone; what is missing is said."""

import json
import re
import shutil
import sys
from dataclasses import asdict

import pytest

from jaxleas import cli
from jaxleas.configuration.loading import to_yaml
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.report_data import count_labels, read_run_data
from jaxleas.evaluation.result_file import write_evaluation
from jaxleas.files import read_json, write_json
from jaxleas.types import CAUSES, InputError

from ..evaluation.test_exact import verdict
from ..reports.test_table import cell, evaluation
from ..training.runs import ROOT

ROUNDS = ROOT / "benchmarks" / "results" / "leas_p2_sampling_rounds.json"


@pytest.fixture
def run(tmp_path):
    """A folder as a distillation leaves it, without its largest files."""
    path = tmp_path / "p2"
    (path / "round_1" / "run").mkdir(parents=True)
    (path / "config.yaml").write_text(to_yaml(DistillationConfig()))
    write_json(path / "begun_with.json", {"run": str(tmp_path / "p1")})
    shutil.copy(ROUNDS, path / "rounds.json")
    rows = [f'{{"step": {n}, "seconds": 1.0, "walk/reward": 0.{n}}}\n' for n in range(1, 40)]
    (path / "round_1" / "run" / "metrics.jsonl").write_text("".join(rows))
    answers = [asdict(verdict(n, n % 3 > 0)) for n in range(6)]
    for each in answers[::3]:
        each["reason"] = f"no foothold at configuration {each['path']}"
        each["cause"] = "no_contact"
    content = {"version": 2, "provenance": {}, "verdicts": answers}
    write_json(path / "round_1" / "labels" / "verdicts" / "g" / "verdicts_000000.json", content)
    return path


def test_what_is_there_is_shown_and_what_is_not_is_named(run, capsys):
    cli.run(["report", str(run)])
    html = (run / "report.html").read_text()
    assert not re.search(r"https?://(?!www\.w3)|<script|src=\"(?!data:)", html)
    best = max(each["success"] for each in json.loads(ROUNDS.read_text())["rounds"])
    assert f"{100 * best:.1f} %" in html
    assert "figures 4.17, 5.6, 5.7, 5.8, 5.9: no figure file" in html
    assert "jaxleas evaluate" in html
    assert "--suite thesis" in html
    assert "is not here" in html
    assert f"2 x {CAUSES['no_contact']}, such as: no foothold at configuration 0" in html
    assert "Table 4.1" not in html
    assert "report.html" in capsys.readouterr().out
    before = html
    cli.run(["report", str(run)])
    assert (run / "report.html").read_text() == before


def test_measured_tables_stand_beside_the_printed_ones(run, tmp_path):
    numbers = {"planner": "sampling", "planned": 0.9, "reached": 0.95, "invalid": 0.0}
    ours = cell(name="rotation", yaw=165.0, speed=0.0, stopped=0.05, low=0.8, high=0.95, **numbers)
    write_evaluation(run / "evaluation" / "thesis.json", evaluation("thesis", ours))
    cli.run(["report", str(run), "--out", str(tmp_path / "r.html")])
    html = (tmp_path / "r.html").read_text()
    assert "Table 4.1" in html
    assert "90.0 % | <em>22.0 %</em>" in html
    assert "1000 starts, seed 0" in html
    assert "tables 4.1" not in html
    assert not (run / "report.html").exists()


def test_labels_are_counted(run):
    count = count_labels(1, run / "round_1" / "labels")
    assert (count.guides, count.passed, count.undecided) == (6, 4, 0)
    (failure,) = count.failures
    assert (failure.count, failure.cause) == (2, CAUSES["no_contact"])
    assert failure.example == "no foothold at configuration 0"
    assert read_run_data(run, "sampling").labels == [count]


@pytest.mark.parametrize(
    ("break_it", "sentence"),
    [
        (lambda run: (run / "rounds.json").unlink(), "no round is finished"),
        (
            lambda run: write_json(run / "rounds.json", {"rounds": []}),
            "rounds: List should have",
        ),
        (
            lambda run: write_json(run / "rounds.json", {"rounds": [{}]}),
            "rounds.0.round: Field",
        ),
        (lambda run: write_json(run / "evaluation" / "x.json", {}), "is no evaluation"),
        (lambda run: write_json(run / "evaluation" / "figures.json", {}), "no figure file"),
    ],
)
def test_damage_is_one_sentence_and_no_report(run, break_it, sentence):
    break_it(run)
    with pytest.raises(InputError, match=sentence):
        cli.run(["report", str(run)])
    assert not (run / "report.html").exists()


def test_the_faithful_mode_has_no_surrogate_to_show(run):
    (run / "config.yaml").write_text(to_yaml(DistillationConfig(mode="faithful")))
    content = read_json(run / "rounds.json")
    for row in content["rounds"]:
        row["surrogate"] = None
    write_json(run / "rounds.json", content)
    cli.run(["report", str(run)])
    html = (run / "report.html").read_text()
    assert "in faithful mode the exact planner judges every episode" in html
    assert 'alt="calibration"' not in html


def test_a_planner_of_ones_own_that_is_gone_is_reported_by_its_name(run):
    (run / "config.yaml").write_text(to_yaml(DistillationConfig(planner="evil:Planner")))
    (run / "evil.py").write_text("raise SystemExit('it ran')")
    cli.run(["report", str(run)])
    html = (run / "report.html").read_text()
    assert "evil:Planner" in html
    assert "leas_p2_evil:Planner=" in html
    assert "evil" not in sys.modules
