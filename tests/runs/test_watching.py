"""Watchers of a run: told the same rows, never in the way, one run from resume to resume."""

import sys
import threading
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest

from jaxleas.runs.metrics import MetricsLog, read_metrics
from jaxleas.runs.watching import Audience, open_watchers, require_watchers
from jaxleas.runs.watching.mlflow_run import PARAMETERS_A_CALL
from jaxleas.types.errors import InputError

CONFIG = {"seed": 0, "ppo": {"learning_rate": 1e-3, "hidden": [16, 16]}}


class Notebook:
    """A watcher that writes down what it is told."""

    def __init__(self) -> None:
        self.told: list = []

    def begin(self, config, name, resumed_after) -> None:
        self.told.append(("begin", name, resumed_after))

    def row(self, step, metrics) -> None:
        self.told.append(("row", step, dict(metrics)))

    def end(self, status) -> None:
        self.told.append(("end", status))


class Broken(Notebook):
    def row(self, step, metrics) -> None:
        super().row(step, metrics)
        raise ConnectionError("no route to host")


class Stuck(Notebook):
    def __init__(self) -> None:
        super().__init__()
        self.released = threading.Event()

    def row(self, step, metrics) -> None:
        self.released.wait(20.0)


def hold(audience: Audience, rows: int) -> None:
    audience.begin(CONFIG, "a", None)
    for step in range(rows):
        audience.row(step, {"x": float(step)})


def test_every_watcher_is_told_everything_in_order() -> None:
    one, other = Notebook(), Notebook()
    audience = Audience({"one": one, "other": other}, pytest.fail)
    hold(audience, 50)
    audience.end("finished")
    rows = [("row", step, {"x": float(step)}) for step in range(50)]
    assert one.told == other.told == [("begin", "a", None), *rows, ("end", "finished")]


def test_a_watcher_that_fails_is_named_once_and_stops_nobody() -> None:
    broken, whole, said = Broken(), Notebook(), []
    audience = Audience({"broken": broken, "whole": whole}, said.append)
    hold(audience, 20)
    audience.end("finished")
    assert [each[0] for each in broken.told] == ["begin", "row"]
    assert len(whole.told) == 22
    (sentence,) = said
    assert sentence.startswith("broken failed and receives nothing more: no route to host")


def test_nobody_waits_for_a_watcher_that_hangs(monkeypatch) -> None:
    monkeypatch.setattr("jaxleas.runs.watching.audience.MOST_WAITING", 10)
    stuck, said = Stuck(), []
    audience = Audience({"stuck": stuck}, said.append, farewell=0.2)
    begun = time.monotonic()
    hold(audience, 1000)
    assert time.monotonic() - begun < 1.0
    audience.end("finished")
    assert time.monotonic() - begun < 2.0
    assert said == [
        "stuck cannot follow and loses rows: metrics.jsonl holds them",
        "stuck is not done after 0.2 s and is left alone: metrics.jsonl holds every row",
    ]
    stuck.released.set()


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (None, "finished"),
        (KeyboardInterrupt(), "interrupted"),
        (type("Stopped", (Exception,), {"exit_code": 130})(), "interrupted"),
        (ValueError(), "failed"),
    ],
)
def test_watchers_hear_how_the_run_ended(tmp_path: Path, monkeypatch, error, status) -> None:
    notebook = Notebook()
    monkeypatch.setattr("jaxleas.runs.metrics.open_watchers", lambda *_: {"it": notebook})

    def run() -> None:
        with MetricsLog(tmp_path / "a") as log:
            log.append(5, {"x": 1.0})
            if error is not None:
                raise error

    if error is None:
        run()
    else:
        with pytest.raises(type(error)):
            run()
    assert notebook.told == [("begin", "a", None), ("row", 5, {"x": 1.0}), ("end", status)]


@pytest.mark.parametrize("name", ["wandb", "mlflow"])
def test_a_missing_client_is_one_sentence_and_leaves_nothing(
    name: str, tmp_path: Path, monkeypatch
) -> None:
    import train

    monkeypatch.setitem(sys.modules, name, None)
    arguments = ["configs/leas_p1_smoke.yaml", "--run-dir", str(tmp_path / "run")]
    with pytest.raises(InputError, match=rf"watch: {name} needs the extra: pip install 'jaxleas"):
        train.main([*arguments, "--watch", f"[tensorboard, {name}]"])
    assert not (tmp_path / "run").exists()


class FakeWandb(ModuleType):
    """As much of W&B's client as is used: steps only go up, a known identity is gone on with."""

    def __init__(self, key: str | None = "k", mode: str = "online") -> None:
        super().__init__("wandb")
        self.runs: dict[str, list] = {}
        self.ends: list[int] = []
        self.inits: list[dict] = []
        self._settings = SimpleNamespace(mode=mode, api_key=key, project=None)

    def setup(self) -> SimpleNamespace:
        return SimpleNamespace(settings=self._settings)

    def login(self, prompt: bool, verify: bool) -> bool:
        assert not prompt
        return self._settings.api_key is not None

    Settings = SimpleNamespace

    def init(self, **given) -> SimpleNamespace:
        assert given["resume"] == "allow"
        self.inits.append(given)
        rows = self.runs.setdefault(given["id"], [])

        def log(metrics: dict, step: int) -> None:
            if not rows or step > rows[-1][0]:
                rows.append((step, metrics))

        return SimpleNamespace(log=log, finish=lambda exit_code: self.ends.append(exit_code))


class FakeMlflow(ModuleType):
    """As much of MLflow's client as is used."""

    def __init__(self) -> None:
        super().__init__("mlflow")
        self.experiments: dict[str, str] = {}
        self.runs: dict[str, SimpleNamespace] = {}
        self.entities = ModuleType("mlflow.entities")
        self.entities.Param = self.entities.RunTag = lambda key, value: (key, value)
        self.entities.Metric = lambda key, value, timestamp, step: (key, value, step)

    def MlflowClient(self) -> "FakeMlflow":  # noqa: N802
        return self

    def get_experiment_by_name(self, name: str) -> SimpleNamespace | None:
        known = self.experiments.get(name)
        return None if known is None else SimpleNamespace(experiment_id=known)

    def create_experiment(self, name: str) -> str:
        return self.experiments.setdefault(name, str(len(self.experiments)))

    def create_run(self, experiment_id: str, run_name: str) -> SimpleNamespace:
        run_id = f"run{len(self.runs)}"
        data = SimpleNamespace(tags={}, params={}, points=[])
        self.runs[run_id] = SimpleNamespace(
            info=SimpleNamespace(run_id=run_id), data=data, name=run_name, status="RUNNING"
        )
        return self.runs[run_id]

    def get_run(self, run_id: str) -> SimpleNamespace:
        return self.runs[run_id]

    def log_batch(self, run_id: str, metrics=(), params=(), tags=()) -> None:
        assert len(params) <= PARAMETERS_A_CALL
        run = self.runs[run_id]
        run.data.points += metrics
        run.data.params.update(params)
        run.data.tags.update(tags)

    def update_run(self, run_id: str, status: str) -> None:
        self.runs[run_id].status = status

    set_terminated = update_run


def write(folder: Path, watch: str, steps: range, after: int | None = None) -> None:
    with MetricsLog(folder, truncate_after_step=after, watch=[watch], config=CONFIG) as log:
        for step in steps:
            log.append(step, {"walk/reward": 0.5 * step})


def test_wandb_goes_on_in_the_same_run(tmp_path: Path, monkeypatch) -> None:
    fake = FakeWandb()
    monkeypatch.setitem(sys.modules, "wandb", fake)
    write(tmp_path / "run", "wandb", range(1, 6))
    write(tmp_path / "run", "wandb", range(4, 9), after=3)
    (rows,) = fake.runs.values()
    assert rows == [(step, {"walk/reward": 0.5 * step}) for step in range(1, 9)]
    assert fake.ends == [0, 0]
    assert [each["project"] for each in fake.inits] == ["jaxleas"] * 2
    assert fake.inits[0]["config"] == CONFIG
    assert fake.inits[0]["name"] == "run"
    write(tmp_path / "other", "wandb", range(1, 2))
    assert len(fake.runs) == 2


def test_wandb_without_a_key_is_refused_unless_offline(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "wandb", FakeWandb(key=None))
    with pytest.raises(InputError, match="knows no key: run `wandb login`, or set WANDB_MODE"):
        require_watchers(["wandb"])
    monkeypatch.setitem(sys.modules, "wandb", FakeWandb(key=None, mode="offline"))
    require_watchers(["wandb"])


def test_mlflow_goes_on_in_the_same_run(tmp_path: Path, monkeypatch) -> None:
    fake = FakeMlflow()
    monkeypatch.setitem(sys.modules, "mlflow", fake)
    monkeypatch.setitem(sys.modules, "mlflow.entities", fake.entities)
    monkeypatch.delenv("MLFLOW_EXPERIMENT_NAME", raising=False)
    write(tmp_path / "run", "mlflow", range(1, 6))
    write(tmp_path / "run", "mlflow", range(4, 9), after=3)
    (run,) = fake.runs.values()
    assert run.data.points == [("walk/reward", 0.5 * step, step) for step in range(1, 9)]
    assert run.data.params["ppo.learning_rate"] == "0.001"
    assert (run.status, run.name) == ("FINISHED", "run")
    assert fake.experiments == {"jaxleas": "0"}


@pytest.mark.parametrize("name", ["wandb", "mlflow"])
def test_an_identity_that_names_nothing_is_told(name: str, tmp_path: Path, monkeypatch) -> None:
    mlflow = FakeMlflow()
    for module, fake in (("wandb", FakeWandb()), ("mlflow", mlflow)):
        monkeypatch.setitem(sys.modules, module, fake)
    monkeypatch.setitem(sys.modules, "mlflow.entities", mlflow.entities)
    (tmp_path / f"{name}.json").write_text("{}")
    said: list[str] = []
    with MetricsLog(tmp_path, watch=[name], say=said.append) as log:
        log.append(1, {"x": 1.0})
    (sentence,) = said
    assert f"{name}.json names no run" in sentence
    assert len(read_metrics(tmp_path / "metrics.jsonl")) == 1


def test_the_real_wandb_offline(tmp_path: Path, monkeypatch) -> None:
    pytest.importorskip("wandb")
    monkeypatch.setenv("WANDB_MODE", "offline")
    write(tmp_path, "wandb", range(1, 6))
    write(tmp_path, "wandb", range(4, 9), after=3)
    logs = list((tmp_path / "wandb").glob("offline-run-*/run-*.wandb"))
    assert len(logs) == 2
    assert len({path.name for path in logs}) == 1  # two sittings of one run


def test_the_real_mlflow_in_a_local_file(tmp_path: Path, monkeypatch) -> None:
    mlflow = pytest.importorskip("mlflow")
    monkeypatch.setenv("MLFLOW_TRACKING_URI", f"sqlite:///{tmp_path / 'mlflow.db'}")
    write(tmp_path, "mlflow", range(1, 6))
    write(tmp_path, "mlflow", range(4, 9), after=3)
    client = mlflow.MlflowClient()
    experiment = client.get_experiment_by_name("jaxleas")
    (run,) = client.search_runs([experiment.experiment_id])
    assert run.info.status == "FINISHED"
    assert run.data.params["ppo.hidden"] == "[16, 16]"
    points = client.get_metric_history(run.info.run_id, "walk/reward")
    assert [(point.step, point.value) for point in points] == [(n, 0.5 * n) for n in range(1, 9)]


def test_watchers_are_found_by_name(tmp_path: Path) -> None:
    (watcher,) = open_watchers(["tensorboard"], tmp_path).values()
    assert type(watcher).__name__ == "TensorBoardWatcher"
