import shutil

import pytest

from jaxleas.envs.steering import GuardConfig
from jaxleas.evaluation.examination import (
    evaluation_file,
    keep_evaluation,
    kept_evaluation,
    load_candidate,
)
from jaxleas.evaluation.progress import Reporter
from jaxleas.evaluation.result_file import read_evaluation
from jaxleas.reports.commands import evaluate, report
from jaxleas.terrain import NoiseConfig
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError
from tests.evaluation.conftest import random_policy


def test_a_run_folder_is_judged_printed_and_kept(run, tmp_path, capsys):
    evaluation = evaluate(run, starts=2, json=tmp_path / "out.json", seed=3)
    assert read_evaluation(tmp_path / "out.json") == evaluation
    assert read_evaluation(evaluation_file(run, "transitions")) == evaluation
    assert len(evaluation.cells) == 24
    assert {cell.method for cell in evaluation.cells} == {"leas_p1", "rb_lin", "rb_kino"}
    assert evaluation.seed == 3
    assert evaluation.robot == "talos"
    shown = capsys.readouterr()
    assert "LEAS-P1" in shown.out
    assert "RB-Lin" in shown.out
    assert shown.err == ""


def test_a_policy_file_is_judged_alone(run, tmp_path, capsys):
    policy = shutil.copy(run / "policy.npz", tmp_path / "mine.npz")
    evaluation = evaluate(policy, suite="hole", starts=2, baseline=False)
    assert [cell.method for cell in evaluation.cells] == ["leas_p1"]
    assert evaluation.policy == str(policy)
    assert "RB-Lin" not in capsys.readouterr().out


def test_an_evaluation_is_kept_for_the_policy_it_judged_only(run):
    path = evaluation_file(run, "hole")
    candidate = load_candidate(run)
    assert kept_evaluation(path, candidate) is None
    evaluation = evaluate(run, suite="hole", starts=1, baseline=False)
    assert kept_evaluation(path, candidate) == evaluation
    (cell,) = evaluation.cells
    more = evaluation.model_copy(update={"cells": (cell.model_copy(update={"starts": 2}),)})
    for each in (more, evaluation):  # the second is a quick look
        keep_evaluation(run, candidate, each)
        assert kept_evaluation(path, candidate) == more
    write_policy(run / "policy.npz", random_policy(seed=1))
    assert kept_evaluation(path, load_candidate(run)) is None
    path.write_text("{}")
    assert kept_evaluation(path, candidate) is None


@pytest.mark.parametrize("starts", [0, -1])
def test_no_starts_are_refused_before_anything_is_loaded(starts, tmp_path):
    with pytest.raises(InputError, match=f"starts = {starts}"):
        evaluate(tmp_path / "nothing", starts=starts)


def test_an_unknown_suite_is_refused_with_the_nearest(tmp_path):
    with pytest.raises(InputError, match="did you mean 'transitions'"):
        evaluate(tmp_path / "nothing", suite="transition")


def test_what_holds_no_policy_is_refused(run, tmp_path):
    (run / "policy.npz").unlink()
    for command in (evaluate, report):
        with pytest.raises(InputError, match=r"policy\.npz"):
            command(run)
        with pytest.raises(InputError, match=r"does not exist|not a run folder"):
            command(tmp_path / "missing")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="not a run folder"):
        evaluate(tmp_path / "empty")


def test_a_report_of_a_file_is_refused(run):
    with pytest.raises(InputError, match="not a run folder"):
        report(run / "policy.npz")


def test_the_candidate_is_walked_by_its_own_configuration(run):
    candidate = load_candidate(run)
    assert list(candidate.methods) == ["leas_p1", "rb_lin", "rb_kino"]
    assert candidate.env.config == candidate.methods["leas_p1"].policy.config  # type: ignore[attr-defined]


class Terminal:
    def __init__(self, live):
        self.live, self.text = live, ""

    def isatty(self):
        return self.live

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def test_progress_is_one_line_in_a_terminal_and_silence_elsewhere(monkeypatch):
    for name in ("CI", "NO_COLOR"):
        monkeypatch.delenv(name, raising=False)
    for live in (True, False):
        stream = Terminal(live)
        with Reporter(stream) as reporter:  # type: ignore[arg-type]
            reporter.say("one")
        assert ("one" in stream.text) == live
        assert "\n" not in stream.text


def test_noise_is_recorded_counted_and_kept_out_of_the_run_folder(run, tmp_path, capsys):
    words = ["white=0.02", "missing=0.05", "fill=0.04"]
    evaluation = evaluate(
        run, suite="hole", starts=2, baseline=False, noise=words, json=tmp_path / "out.json"
    )
    assert read_evaluation(tmp_path / "out.json") == evaluation
    assert not evaluation_file(run, "hole").exists()
    assert evaluation.noise == NoiseConfig(white=0.02, missing=0.05, fill=0.04)
    assert evaluation.guard == GuardConfig()
    cells = evaluation.map_cells
    assert cells is not None
    assert cells.missing == pytest.approx(0.05, abs=0.01)
    assert cells.filled + cells.unknown == pytest.approx(cells.missing, abs=2e-6)
    assert 0.0 < cells.unknown < cells.filled
    assert "of the ground's cells in the maps 5." in capsys.readouterr().out
    with pytest.raises(InputError, match="no height known around any start of 'hole'"):
        evaluate(run, suite="hole", starts=2, baseline=False, noise=["missing=1"])


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"noise": ["white=3"]}, "--noise: white is 3, but it should be less than or equal"),
        ({"noise": ["delay=1"], "planners": ["mip"]}, "leave out --planners"),
    ],
)
def test_impossible_noise_is_refused_before_anything_is_loaded(options, says, tmp_path):
    with pytest.raises(InputError, match=says):
        evaluate(tmp_path / "nothing", suite="hole", **options)
