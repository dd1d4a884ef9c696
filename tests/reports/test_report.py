import re
from html.parser import HTMLParser

import pytest

from jaxleas.evaluation.examination import load_candidate
from jaxleas.evaluation.report_basis import make_report_basis
from jaxleas.reports.gallery import draw_gallery
from jaxleas.reports.picture import Picture
from jaxleas.reports.run_report import headlines, render_report, success_rows
from tests.evaluation.conftest import StandStill
from tests.reports.test_table import cell, evaluation

METRICS = [
    {"step": 1000 * index, "seconds": 2.0 * index, "walk/reward": 0.1 * index}
    | ({"held_out/reached": 0.1 * index} if index % 2 else {})
    | {"learn/policy_loss": None}
    for index in range(1, 9)
]


def evaluations():
    kinds = ("rubble", "bridge", "stairs_down", "stairs_up")
    both = [
        cell(name=kind, yaw=yaw, method=method)
        for kind in kinds
        for yaw in (0.0, 180.0)
        for method in ("leas_p1", "rb_lin")
    ]
    stop = cell(name="void", expectation="stop", reached=0.0, invalid=0.01, stopped=0.99)
    return [evaluation("transitions", *both), evaluation("dead_end", stop)]


class Links(HTMLParser):
    def __init__(self):
        super().__init__()
        self.found, self.open, self.tags = [], [], set()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.found += [value for name, value in attrs if name in ("src", "href", "srcset", "data")]
        if tag not in ("meta", "img", "br", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture
def html(run):
    return render_report(run, METRICS, evaluations(), [Picture("view", "A & B.", b"png")])


def test_the_report_needs_nothing_but_itself(html):
    page = Links()
    page.feed(html)
    assert page.found
    assert all(value.startswith("data:image/png;base64,") for value in page.found)
    assert not page.open, "every element is closed"
    assert not page.tags & {"script", "link", "iframe", "object"}
    assert not re.search(r"url\(|@import|https?://", html)


def test_text_from_files_cannot_become_markup(html):
    assert "<b>not markup</b>" not in html
    assert "&lt;b&gt;not markup&lt;/b&gt;" in html


def test_the_same_inputs_give_the_same_report(run, html):
    again = render_report(run, METRICS, evaluations(), [Picture("view", "A & B.", b"png")])
    assert again == html


def test_it_says_what_matters(html):
    for text in (
        "98.5 %",
        "thesis, table 3.3",
        "87 %",
        "some_run",
        "A &amp; B.",
        "learning curves",
    ):
        assert text in html
    assert "None" not in html


def test_a_policy_without_history_has_no_curves(tmp_path):
    html = render_report(tmp_path, [], evaluations(), [])
    assert "learning curves" not in html
    assert "Configuration" not in html


def test_headlines_are_the_worst_cells_and_the_mean_of_dead_ends():
    by_suite = {each.suite: each for each in evaluations()}
    numbers = {words: number for number, words in headlines(by_suite, METRICS)}
    assert numbers["of 1000 starts with the back to it, in the worst cell (rubble)"] == "98.5 %"
    assert numbers["of 1000 starts at dead ends meet an invalid configuration"] == "1.0 %"
    assert numbers["of training, 0.0 million steps"] == "16 s"


def test_the_success_table_has_the_shape_of_the_thesis():
    table = success_rows(evaluations()[0])
    assert [(row.heading, row.method) for row in table] == [
        (yaw, method)
        for yaw in ("0°", "180°")
        for method in ("LEAS-P1", "RB-Lin", "thesis, table 3.3")
    ]
    assert [value for value, _ in table[-1].values] == ["100 %", "87 %", "100 %", "97 %"]
    assert success_rows(None) == []


def test_the_gallery_draws_every_kind_of_scene(env):
    basis = make_report_basis(env.robot, starts=4)
    pictures = draw_gallery(env, {"leas_p1": StandStill()}, basis)
    assert [each.name for each in pictures] == [
        "transitions",
        "profile",
        "detours",
        "circuit",
        "dead_ends",
    ]
    for picture in pictures:
        assert picture.png.startswith(b"\x89PNG")
        assert 5_000 < len(picture.png) < 600_000


@pytest.mark.slow
def test_the_report_command_judges_what_is_missing_and_writes_one_file(run, capsys):
    from jaxleas.reports.commands import evaluate, report

    evaluate(run, starts=4)
    (run / "metrics.jsonl").write_text('{"step": 1, "seconds": 2.0, "walk/reward": 1.0}\n')
    out = report(run)
    assert out == run / "report.html"
    assert out.stat().st_size < 5_000_000
    suites = ["circuit", "dead_end", "hole", "transitions", "wall"]
    assert sorted(each.stem for each in (run / "evaluation").iterdir()) == suites
    assert len(list((run / "pictures").iterdir())) == 5
    before = out.read_bytes()
    report(run)
    assert out.read_bytes() == before
    assert load_candidate(run).env.config.robot == "talos"
    assert str(out) in capsys.readouterr().out
