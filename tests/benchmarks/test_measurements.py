"""Medians, ratios, the JSON format, and the verdict against a baseline."""

import json

import pytest

from benchmarks.comparison import by_name, compare
from benchmarks.context import Context
from benchmarks.measurements import (
    Figure,
    Measurement,
    Metric,
    median,
    read_measurements,
    this_machine,
    write_measurements,
)
from benchmarks.suite import choose, measure
from benchmarks.workloads import WORKLOADS, Workload
from jaxleas.types.errors import InputError

KEYS = ["name", "value", "unit", "better", "runs", "machine", "rival", "ratio", "limit", "of_limit"]
FASTER = Metric("env_test", "steps/s", "higher", tolerance=0.1)
QUICKER = Metric("export_test", "us", "lower", tolerance=0.1)


def entry(metric, *runs, **figure) -> Measurement:
    return Measurement.of(metric, Figure(runs, **figure), "here")


def test_the_file_is_as_documented(tmp_path):
    path = tmp_path / "out.json"
    entries = [entry(FASTER, 3.0, 1.0, 2.0, limit=4.0, rival=0.5), entry(QUICKER, 2.0)]
    write_measurements(path, entries)
    first, second = json.loads(path.read_text())
    assert list(first) == list(second) == KEYS
    assert first["value"] == 2.0
    assert first["runs"] == [3.0, 1.0, 2.0]
    assert (first["ratio"], first["of_limit"]) == (4.0, 0.5)
    assert second["rival"] is second["ratio"] is second["limit"] is second["of_limit"] is None
    assert read_measurements(path) == entries


def test_where_lower_is_better_ratios_are_turned_round():
    latency = entry(QUICKER, 20.0, rival=100.0, limit=5.0)
    assert (latency.ratio, latency.of_limit) == (5.0, 0.25)


def test_a_run_that_never_got_there_is_the_worst():
    assert median([30.0, None, 20.0], "lower") == 30.0
    assert median([30.0, None, None], "lower") is None
    assert median([30.0, None], "lower") is None
    assert median([1.0, None, 2.0], "higher") == 1.0
    assert median([1.0, 2.0], "higher") == 1.5
    assert entry(QUICKER, None, rival=3.0).ratio is None


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{}", "needs a list"),
        ('[{"name": "env_a"}]', "entry 0"),
        ("[3]", "entry 0"),
        ("nothing", "not valid JSON"),
    ],
)
def test_other_files_are_refused(tmp_path, text, complaint):
    path = tmp_path / "baseline.json"
    path.write_text(text)
    with pytest.raises(InputError, match=complaint):
        read_measurements(path)


@pytest.mark.parametrize("metric", [FASTER, QUICKER])
def test_verdicts_turn_round_when_the_files_are_swapped(metric):
    opposite = {"better": "worse", "worse": "better", "within": "within"}
    seen = set()
    for value in (50.0, 85.0, 95.0, 100.0, 105.0, 109.0, 111.0, 150.0):
        now, before = entry(metric, value), entry(metric, 100.0)
        forth = compare(metric, now, by_name([before])).verdict
        back = compare(metric, before, by_name([now])).verdict
        assert back == opposite[forth]
        seen.add(forth)
    assert seen == set(opposite)


def test_verdicts_follow_the_direction():
    before = by_name([entry(FASTER, 100.0), entry(QUICKER, 100.0)])
    assert compare(FASTER, entry(FASTER, 120.0), before).verdict == "better"
    assert compare(QUICKER, entry(QUICKER, 120.0), before).verdict == "worse"
    assert compare(QUICKER, entry(QUICKER, None), before).verdict == "worse"
    never = by_name([entry(QUICKER, None)])
    assert compare(QUICKER, entry(QUICKER, 120.0), never).verdict == "better"
    assert compare(QUICKER, entry(QUICKER, None), never).verdict == "within"
    assert compare(FASTER, entry(FASTER, 1.0), {}).verdict == "new"


def test_names_are_unique_and_say_what_they_are():
    names = [metric.name for workload in WORKLOADS for metric in workload.metrics]
    assert len(names) == len(set(names))
    assert all(name.startswith(("env_", "ppo_", "learn_", "export_", "walk_")) for name in names)


def test_choosing():
    every = choose([], quick=False)
    assert {m.name for m in choose([], quick=True)} < {m.name for m in every}
    assert all(m.name.startswith("env_") for m in choose(["env_"], quick=False))
    assert {m.name for m in choose(["export_", "compile"], quick=False)} == {
        m.name for m in every if m.name.startswith("export_") or "compile" in m.name
    }
    # A whole name is that metric alone, although it is part of another's.
    assert [m.name for m in choose(["export_latency_1"], False)] == ["export_latency_1"]
    # What is slow is still measured if nothing else was asked for.
    assert choose(["learn_"], quick=True) == choose(["learn_"], quick=False)
    with pytest.raises(InputError, match="did you mean env_"):
        choose(["envv_"], quick=False)


def test_each_workload_is_measured_once_and_only_if_wanted():
    calls = []

    def workload(*names):
        def act(context):
            calls.append(names)
            return {name: Figure([1.0]) for name in names}

        return Workload(tuple(Metric(name, "s") for name in names), act)

    workloads = (workload("env_a", "env_b"), workload("ppo_c"))
    wanted = workloads[0].metrics
    assert [m.name for m in measure(wanted, Context(runs=1), workloads=workloads)] == [
        "env_a",
        "env_b",
    ]
    assert calls == [("env_a", "env_b")]


def test_the_machine_has_a_name():
    assert "cores" in this_machine()
