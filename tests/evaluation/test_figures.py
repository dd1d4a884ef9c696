"""Figures 4.17 and 5.6 to 5.9: what is measured, kept, gone on with and drawn."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.evaluation.figure_file import Figures, StepRow, read_figures, write_figures
from jaxleas.evaluation.figure_rows import step_lengths
from jaxleas.evaluation.figures import COURSE
from jaxleas.evaluation.figures_command import _opened
from jaxleas.files import read_json, write_json
from jaxleas.labels import Judge
from jaxleas.reports.figure_pictures import draw_figures
from jaxleas.types import InputError
from tests.evaluation.test_exact import verdict


def test_steps_are_straight_ways_between_kept_configurations():
    generator = np.random.default_rng(0)
    path = np.cumsum(generator.normal(size=(23, 3)), axis=0)
    steps = step_lengths(path, 5)
    slow = [np.sqrt(((path[a + 5] - path[a]) ** 2).sum()) for a in (0, 5, 10, 15)]
    np.testing.assert_allclose(steps, slow)
    assert len(step_lengths(path[:5], 5)) == 0


@pytest.fixture
def asked(monkeypatch):
    """Planners that get through when few configurations are left out, and say so at once."""
    calls = []

    def judge(self, scenes, paths, scene_index, on_done=lambda count: None):
        calls.append((self.settings.keep_every, len(paths)))
        good = self.settings.keep_every < 10
        return [verdict(number, good) for number in range(len(paths))]

    monkeypatch.setattr(Judge, "judge", judge)
    return calls


@pytest.mark.slow
def test_the_file_grows_and_the_same_command_goes_on(run, tmp_path, asked, monkeypatch):
    out = tmp_path / "figures.json"
    command = ["figures", str(run), "--out", str(out), "--starts", "4", "--course-starts", "2"]
    command += ["--methods", "rb_kino", "--processes", "1", "--keep-every", "6", "14"]
    cli.run(command)
    found = read_figures(out)
    assert len(found.steps) == 8
    assert [row.planned > 0 for row in found.steps if row.cell == "rubble"] == [True, False]
    assert len(asked) <= 8
    assert {band.method for band in found.heights} == {"rb_kino"}
    content = read_json(out)
    content["steps"] = content["steps"][:-1]
    write_json(out, content)
    asked.clear()
    cli.run(command)
    assert len(asked) <= 1
    assert read_figures(out).steps == found.steps


def row(cell, method, keep_every):
    return StepRow(
        cell=cell,
        method=method,
        keep_every=keep_every,
        starts=30,
        reached=1.0,
        planned=0.5,
        low=0.3,
        high=0.7,
        mean_step=0.02 * keep_every,
        steps=400 / keep_every,
        seconds=None if keep_every == 20 else 0.1,
        slowest=0.2,
    )


def figures(**changes):
    values = {
        "created": "2026-01-01",
        "planner": "mip",
        "settings": {"keep_every": 14},
        "policies": {"leas_p1": "a" * 64},
        "seed": 0,
        "held_out": False,
    }
    return Figures.model_validate(values | changes)


def test_only_what_was_measured_is_drawn():
    assert draw_figures(figures()) == []
    rows = tuple(row("rubble", name, n) for name in ("rb_kino", "leas_p1") for n in (6, 14, 20))
    pictures = {each.name: each for each in draw_figures(figures(steps=rows))}
    assert list(pictures) == ["figure 5.6", "figure 5.7"]
    assert "30 starts a scenario, MIP planner, evaluation seed 0" in pictures["figure 5.6"].caption
    assert "The thesis, figure 5.6: 30 guide paths" in pictures["figure 5.6"].caption
    whole = figures(
        steps=(row(COURSE, "leas_p1", 14),),
        along=[0.0, 1.0],
        ground=[0.0, None],
        heights=[
            {
                "method": "leas_p1",
                "guides": 3,
                "low": [0.8, None],
                "mean": [0.9, None],
                "high": [1.0, None],
                "clearance": 0.9,
            }
        ],
        course_along=[0.0, 1.0],
        course_ground=[0.0, 0.1],
        courses=[
            {"method": "leas_p1", "reached": True, "planned": False, "x": [0.0], "step": [0.2]}
        ],
    )
    assert [each.name for each in draw_figures(whole)] == [
        "figure 4.17",
        "figure 5.8",
        "figure 5.9",
    ]


def test_a_file_of_something_else_is_not_gone_on_with(tmp_path):
    out = tmp_path / "f.json"
    write_figures(out, figures())
    assert _opened(out, figures(policies={"leas_p2_mip": "b" * 64})).policies.keys() == {
        "leas_p1",
        "leas_p2_mip",
    }
    with pytest.raises(InputError, match="another policy leas_p1"):
        _opened(out, figures(policies={"leas_p1": "b" * 64}))
    with pytest.raises(InputError, match="has planner mip, not sl1m"):
        _opened(out, figures(planner="sl1m"))
    write_json(out, read_json(out) | {"seed": "x"})
    with pytest.raises(InputError, match="no figure file: seed"):
        read_figures(out)
