"""Runs side by side: only what differs, and whether a difference can be chance."""

import json
from pathlib import Path

import pytest

from jaxleas.cli import run as command
from jaxleas.files import read_json, write_json
from jaxleas.records import compare_runs, read_record
from jaxleas.records.comparison import Score, apart
from jaxleas.records.side_by_side import names_of
from tests.records.folders import judge, make_run


@pytest.fixture
def pair(tmp_path: Path) -> list[Path]:
    one = make_run(tmp_path / "one" / "run", seed=1)
    other = make_run(tmp_path / "other" / "run", updates=4, seed=1, ppo={"clip": 0.3})
    judge(one, {"bridge": 200, "rubble": 150})
    judge(other, {"bridge": 100, "rubble": 148})
    provenance = read_json(other / "provenance.json")
    provenance["packages"]["jax"] = "0.9"
    write_json(other / "provenance.json", provenance)
    return [one, other]


def test_only_what_differs(pair: list[Path]) -> None:
    comparison = compare_runs([read_record(path) for path in pair])
    assert comparison.config == {"ppo.clip": [0.2, 0.3]}
    assert list(comparison.provenance) == ["packages.jax"]
    assert comparison.provenance["packages.jax"][1] == "0.9"


def test_success_side_by_side(pair: list[Path]) -> None:
    scores = compare_runs([read_record(path) for path in pair]).scores
    bridge, rubble = scores["transitions", "bridge 0°"], scores["transitions", "rubble 0°"]
    assert [each and each.success for each in bridge] == [1.0, 0.5]
    assert apart(bridge)
    assert not apart(rubble)


def test_intervals_that_touch_are_not_apart() -> None:
    low, middle, high = (Score(x, x - 0.1, x + 0.1, 100) for x in (0.2, 0.4, 0.7))
    assert not apart([low, middle])
    assert apart([low, middle, high])
    assert not apart([low, None])
    assert not apart([None, None])


def test_curves_end_where_a_run_ends(pair: list[Path]) -> None:
    curves = compare_runs([read_record(path) for path in pair]).curves
    assert [*curves] == [800 * n for n in range(1, 11)]
    assert curves[800] == [None, None]  # not examined yet
    whole, half = curves[4000]
    assert whole.success == half.success == 0.45
    assert whole.low < 0.45 < whole.high
    assert curves[8000][1] is None
    assert curves[8000][0].success == 0.9


def test_names_are_as_short_as_they_differ(pair: list[Path], tmp_path: Path) -> None:
    comparison = compare_runs([read_record(path) for path in pair])
    assert names_of(comparison) == ["one/run", "other/run"]
    third = make_run(tmp_path / "third")
    assert names_of(compare_runs([read_record(path) for path in (pair[0], third)])) == [
        "run",
        "third",
    ]


def test_the_command_writes_what_it_says(pair: list[Path], tmp_path: Path, capsys) -> None:
    files = {kind: tmp_path / f"c.{kind}" for kind in ("json", "png", "html")}
    outputs = ["--json", str(files["json"]), "--html", str(files["html"])]
    command(["compare", *map(str, pair), *outputs, "--picture", str(files["png"])])
    printed = capsys.readouterr().out
    assert "ppo.clip" in printed
    assert "100.0 % (98.1 to 100.0)" in printed
    content = json.loads(files["json"].read_text())
    assert content["config"] == {"ppo.clip": [0.2, 0.3]}
    assert [each["apart"] for each in content["success"]] == [True, False]
    assert files["png"].read_bytes().startswith(b"\x89PNG")
    page = files["html"].read_text()
    assert "ppo.clip" in page
    assert "http" not in page
