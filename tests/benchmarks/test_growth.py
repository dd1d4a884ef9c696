"""The picture of growth: what it needs is measured, and nothing missing goes unsaid."""

import pytest
from matplotlib.figure import Figure

from benchmarks.growth import AXES, draw_growth, main
from benchmarks.measurements import Figure as Measured
from benchmarks.measurements import Measurement, Metric, write_measurements
from benchmarks.workloads import WORKLOADS
from benchmarks.workloads.training import memory_name
from jaxleas.cli_guard import UsageError
from jaxleas.types import InputError

METRICS = {metric.name: metric for each in WORKLOADS for metric in each.metrics}


def entry(metric: Metric, value: float) -> Measurement:
    return Measurement.of(metric, Measured([value]), "a machine")


@pytest.fixture
def measurements() -> list[Measurement]:
    return [entry(metric, 100.0 + place) for place, metric in enumerate(METRICS.values())]


def test_every_point_is_drawn_where_it_belongs(measurements, tmp_path, monkeypatch):
    drawn = []
    save = Figure.savefig
    monkeypatch.setattr(
        Figure, "savefig", lambda self, *a, **k: drawn.append(self) or save(self, *a, **k)
    )
    draw_growth(measurements, tmp_path / "growth.png")
    assert [each.name for each in tmp_path.iterdir()] == ["growth.png"]
    values = {each.name: each.value for each in measurements}
    plots = drawn[0].axes
    for place, axis in enumerate(AXES):
        above, below = plots[place], plots[len(AXES) + place]
        lines = [dict(zip(*line.get_data(), strict=True)) for line in above.lines]
        for names in (axis.environment, axis.training):
            assert {x: values[name] for x, name in names.items()} in lines
        (memory,) = (dict(zip(*line.get_data(), strict=True)) for line in below.lines)
        assert memory == {x: values[memory_name(name)] for x, name in axis.training.items()}
        assert len(axis.training) >= 2


@pytest.mark.parametrize("missing", ["ppo_65536", "ppo_memory_width_512", "env_arenas_16"])
def test_what_is_missing_is_said(measurements, missing, tmp_path):
    path = tmp_path / "some.json"
    write_measurements(path, [each for each in measurements if each.name != missing])
    with pytest.raises(InputError, match=rf"1 of the \d+ figures .* --only {missing}"):
        main([str(path), "--out", str(tmp_path / "growth.png")])
    assert [each.name for each in tmp_path.iterdir()] == ["some.json"]


def test_another_kind_of_file_is_refused(tmp_path):
    with pytest.raises(UsageError, match=r"ends in \.png or \.svg"):
        main(["some.json", "--out", str(tmp_path / "growth.txt")])
