"""One run as recorded in its folder, whatever its state."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from jaxleas.configuration import read_mapping, with_present_names
from jaxleas.envs import DEFAULT_TASK, TASKS
from jaxleas.evaluation import CellResult, Evaluation, read_evaluation
from jaxleas.files import is_held, read_json
from jaxleas.guide import is_policy
from jaxleas.runs import POLICY_FILE, read_metrics
from jaxleas.training import RunConfig, run_config_of
from jaxleas.types import InputError

State = Literal["finished", "running", "interrupted", "damaged"]
HELD_OUT = "held_out/reached"
SUITE = "transitions"
"""The suite by which runs are listed."""


@dataclass(frozen=True)
class RunRecord:
    """The known facts of a run; an unknown one is None or empty.

    Attributes:
        path: folder of the run.
        state: state of the run; damaged if one of its files cannot be read.
        problem: problem of a damaged run, in a sentence.
        created: time of its start, ISO 8601, UTC.
        source: stem of the configuration file it was trained from.
        revision: git revision, twelve digits, with a + where files were changed.
        config: resolved configuration, flat: values by dotted key.
        provenance: provenance, flat: values by dotted key.
        metrics: rows of metrics.jsonl.
        steps: number of steps done.
        total: number of steps to be done in all.
        seconds: duration of training [s].
        held_out: best share of held-out starts that reached the goal.
        evaluations: results by suite.
    """

    path: Path
    state: State = "damaged"
    problem: str = ""
    created: str | None = None
    source: str | None = None
    revision: str | None = None
    config: Mapping[str, Any] = field(default_factory=dict)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    metrics: tuple[Mapping[str, Any], ...] = ()
    steps: int = 0
    total: int | None = None
    seconds: float | None = None
    held_out: float | None = None
    evaluations: Mapping[str, Evaluation] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the run's folder."""
        return str(self.path)

    @property
    def success(self) -> float | None:
        """Mean success over the cells of the transitions suite, if the run was judged on it."""
        cells = self.cells(SUITE)
        return sum(cell.success for cell in cells) / len(cells) if cells else None

    @property
    def differences(self) -> dict[str, Any]:
        """Values of the configuration that differ from the defaults."""
        usual = defaults(self.config.get("env.task", DEFAULT_TASK))
        return {key: value for key, value in self.config.items() if usual.get(key) != value}

    def cells(self, suite: str) -> list[CellResult]:
        """Return the cells of a suite in which the run's policy was judged by the conditions."""
        found = self.evaluations.get(suite)
        cells = () if found is None else found.cells
        return [each for each in cells if is_policy(each.method) and each.planner is None]


def read_record(path: str | Path) -> RunRecord:
    """Return the record of a run's folder; a damaged run is a state, not an exception."""
    path = Path(path)
    found: dict[str, Any] = {}
    problems = []
    for read in (_config, _provenance, _metrics, _evaluations):
        try:
            found |= read(path)
        except InputError as error:
            problems.append(str(error))
        except (KeyError, TypeError, ValueError, ArithmeticError, AttributeError, OSError) as error:
            problems.append(f"{path}: {read.__name__[1:]} cannot be understood: {error!r}")
    done = found.get("steps", 0) >= (found.get("total") or float("inf"))
    finished = done and (path / POLICY_FILE).is_file()
    # Only runs that may be running are asked: asking holds the lock for a moment.
    state: State = "finished" if finished else "running" if is_held(path) else "interrupted"
    if problems and state != "running":  # a run that is just beginning is not complete yet
        state = "damaged"
    return RunRecord(path, state, problem=problems[0] if problems else "", **found)


def flat(value: Any, prefix: str = "") -> dict[str, Any]:
    """Return nested mappings as one mapping with dotted keys."""
    if not isinstance(value, Mapping):
        return {prefix.removesuffix("."): value}
    return {
        name: inner
        for key, each in value.items()
        for name, inner in flat(each, f"{prefix}{key}.").items()
    }


def defaults(task: str = DEFAULT_TASK) -> dict[str, Any]:
    """Return the default configuration of a task, flat.

    For a user's own task, whose code a list of runs does not run, it has the sections that every
    run has.
    """
    if task in TASKS:
        return flat(run_config_of(task)().model_dump(mode="json"))
    common = RunConfig.model_fields.keys() - {"env", "terrain"}
    whole = run_config_of(DEFAULT_TASK)().model_dump(mode="json", include=common)
    return flat(whole) | {"env.task": task}


def _config(path: Path) -> dict[str, Any]:
    if not (path / "config.yaml").is_file():
        raise InputError(f"{path} is half-written: it holds no config.yaml")
    # Not validated: a run of another version is still a run.
    plain = _plain(read_mapping(path / "config.yaml"))
    task = plain["env"].get("task") if isinstance(plain.get("env"), dict) else None
    usual = defaults(str(task or DEFAULT_TASK))
    model = run_config_of(DEFAULT_TASK)
    stated = flat(with_present_names(model, plain, str(path / "config.yaml")))
    if crushed := next((key for key in stated if any(k.startswith(f"{key}.") for k in usual)), ""):
        raise InputError(f"{path / 'config.yaml'}: {crushed} should hold `key: value` pairs")
    config = usual | stated
    robots, unroll, steps = (
        _count(path, config, f"ppo.{name}") for name in ("environments", "unroll", "steps")
    )
    batch = robots * unroll
    return {"config": config, "total": -(-steps // batch) * batch}


def _count(path: Path, config: Mapping[str, Any], name: str) -> int:
    value = config[name]
    if type(value) is not int or value < 1:
        raise InputError(f"{path / 'config.yaml'}: {name} is {value!r:.40}, which is no count")
    return value


def _provenance(path: Path) -> dict[str, Any]:
    if not (path / "provenance.json").is_file():
        raise InputError(f"{path} is half-written: it holds no provenance.json")
    provenance = read_json(path / "provenance.json")
    git = provenance["git"]
    sources = [word for word in provenance["command"] if str(word).endswith((".yaml", ".yml"))]
    return {
        "provenance": flat(provenance),
        "created": str(provenance["created"]),
        "source": Path(sources[0]).stem if sources else None,
        "revision": git and str(git["revision"])[:12] + ("+" if git["changed"] else ""),
    }


def _metrics(path: Path) -> dict[str, Any]:
    if not (path / "metrics.jsonl").is_file():
        return {}
    rows = read_metrics(path / "metrics.jsonl")
    examined = [float(row[HELD_OUT]) for row in rows if row.get(HELD_OUT) is not None]
    if not all(0.0 <= each <= 1.0 for each in examined):
        raise InputError(f"{path / 'metrics.jsonl'} holds a {HELD_OUT} that is no fraction")
    return {
        "metrics": tuple(rows),
        "steps": int(rows[-1]["step"]) if rows else 0,
        "seconds": float(rows[-1]["seconds"]) if rows else None,
        "held_out": max(examined, default=None),
    }


def _evaluations(path: Path) -> dict[str, Any]:
    found = [read_evaluation(file) for file in sorted((path / "evaluation").glob("*.json"))]
    return {"evaluations": {each.suite: each for each in found}}


def _plain(value: Any) -> Any:
    """Return YAML values as JSON values: a date, for example, becomes text."""
    return json.loads(json.dumps(value, default=str))
