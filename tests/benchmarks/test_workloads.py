"""The measurements themselves, on tiny sizes: they run, and their numbers have a meaning."""

import json
import time
from functools import partial
from types import SimpleNamespace

import jax
import jax.numpy as jnp
import pytest

from benchmarks.context import Context
from benchmarks.measurements import Figure
from benchmarks.timing import seconds_a_call
from benchmarks.workloads import environment, export, learning, training
from benchmarks.workloads.processes import ChildError, run
from tests.training.runs import tiny


@pytest.fixture
def context(monkeypatch) -> Context:
    """Tiny sizes, and roofs that are given."""
    context = Context(runs=2)
    context.config = tiny()
    rates = SimpleNamespace(matrix=1e12, memory=1e12, gather=1e12)
    context.__dict__["roofs"] = SimpleNamespace(
        rates=lambda *_, **__: rates, large_products=lambda _: 1e12
    )
    for module in (environment, export, training):
        quick = partial(seconds_a_call, least_seconds=0.01)
        monkeypatch.setattr(module, "seconds_a_call", quick)
    return context


def test_a_call_takes_what_it_takes():
    seconds = seconds_a_call(lambda: time.sleep(0.02), runs=3, least_seconds=0.05)
    assert len(seconds) == 3
    assert all(each >= 0.02 for each in seconds)


def below_its_limit(figure: Figure) -> bool:
    runs = [run for run in figure.runs if run is not None]
    assert len(runs) == len(figure.runs) == 2
    return figure.limit is not None and 0.0 < max(runs) < figure.limit


@pytest.mark.slow
def test_the_environment(context):
    (figure,) = environment._measure("icra81", 64, context).values()
    assert below_its_limit(figure)
    assert figure.rival is None


@pytest.mark.slow
def test_without_restarts_robots_that_have_failed_walk_on(context):
    env = context.env
    walk = environment._make_walk(env, 50, 64, 0)
    state = environment._begin(env, context.world, 64)
    begun = state[0].step.copy()
    state, _ = walk(context.world, state)
    assert (state[0].step == begun + 50).all()


@pytest.mark.slow
def test_robots_that_fail_are_restarted(context):
    env = context.env
    walk = environment._make_walk(env, 50, 64, 64)
    state, _ = walk(context.world, environment._begin(env, context.world, 64))
    for _ in range(8):
        state, _ = walk(context.world, state)
    assert int(jnp.min(state[0].step)) < 400 == 8 * 50
    assert len(jnp.unique(jax.random.key_data(state[2]))) > 1


@pytest.mark.parametrize("batch", [1, 1024])
def test_latency(context, batch):
    (figure,) = export._measure(batch, context).values()
    assert figure.limit is not None
    assert all(run is not None and run > figure.limit > 0.0 for run in figure.runs)


@pytest.mark.slow
def test_training(context, brax_ranks):
    figures = training._as_shipped(context)
    memory = training.memory_name(training.AS_SHIPPED)
    assert set(figures) == {training.AS_SHIPPED, training.AGAINST_SIX, memory}
    figure = figures[training.AS_SHIPPED]
    assert below_its_limit(figure)
    # At least the terrain and the batch's observations, which are held at once.
    ppo, words = context.config.ppo, context.world.atlas.heights.size
    least = 4 * (words + ppo.batch * context.env.layout.size) / 2**20
    (held,) = figures[memory].runs
    assert held is not None
    assert least < held < 100.0 * least


def test_processes_are_weighed_and_their_failures_told(tmp_path):
    words = ["-c", "held = bytearray(b'x') * (200 * 2**20); print('done')"]
    finished = run(words, tmp_path / "cache", tmp_path / "log")
    assert finished.output == "done\n"
    assert 200.0 < finished.peak < 260.0, "its own memory, not that of this process"
    with pytest.raises(ChildError, match="no luck"):
        run(["-c", "raise SystemExit('no luck')"], tmp_path / "cache", tmp_path / "log")


def test_learning_curves_are_read_while_training(tmp_path, monkeypatch):
    rows = [
        {"step": n, "seconds": n, "held_out/reached": share} for n, share in enumerate((0.5, 1))
    ]
    path = tmp_path / "run_0" / "metrics.jsonl"
    lines = [json.dumps(row) for row in rows]
    program = (
        "import sys, time, pathlib; path = pathlib.Path(sys.argv[1]); path.parent.mkdir()\n"
        "stream = path.open('w', buffering=1)\n"
        "for line in sys.argv[2:]: time.sleep(0.3); stream.write(line + '\\n')\n"
    )
    real = learning.start

    def start(words, cache, log):
        assert "--seed" in words
        return real(["-c", program, str(path), *lines], cache, log)

    monkeypatch.setattr(learning, "start", start)
    curve = learning.learning_curve(tmp_path / "config.yaml", tmp_path, 0)
    (first, half), (second, whole) = curve
    assert (half, whole) == (0.5, 1.0)
    assert 0.3 <= first < second
