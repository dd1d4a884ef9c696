"""MLflow; set up by its own variables (MLFLOW_TRACKING_URI, MLFLOW_EXPERIMENT_NAME, ...)."""

import os
import time
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from jaxleas.runs.watching.identity import lasting_identity
from jaxleas.runs.watching.watcher import Status

EXPERIMENT = "jaxleas"
"""Name of the experiment if MLFLOW_EXPERIMENT_NAME is not set."""
STATUS: dict[Status, str] = {"finished": "FINISHED", "interrupted": "KILLED", "failed": "FAILED"}
STEP_TAG = "jaxleas.step"  # tag with the step of the run's last row
PARAMETERS_A_CALL = 100  # MLflow's limit


class MlflowWatcher:
    """A run of MLflow; a resumed training continues it.

    It uses the client alone, not MLflow's "active run", which belongs to the user's own program.

    Args:
        folder: run folder, which holds the identity in `mlflow.json`.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._last = -1

    def begin(self, config: Mapping[str, Any], name: str, resumed_after: int | None) -> None:
        """Open the run; rows that it already has are skipped."""
        self._client: Any = import_module("mlflow").MlflowClient()
        self._entities: Any = import_module("mlflow.entities")
        self._run = lasting_identity(self._folder / "mlflow.json", lambda: self._make(name))
        if resumed_after is not None:
            self._client.update_run(self._run, status="RUNNING")
            tags = self._client.get_run(self._run).data.tags
            self._last = int(tags.get(STEP_TAG, -1))
        parameters = [self._entities.Param(key, value) for key, value in flat(config)]
        for first in range(0, len(parameters), PARAMETERS_A_CALL):
            self._client.log_batch(self._run, params=parameters[first : first + PARAMETERS_A_CALL])

    def row(self, step: int, metrics: Mapping[str, float]) -> None:
        """Send one row in one call."""
        if step <= self._last:
            return
        now = int(1000 * time.time())
        points = [self._entities.Metric(name, value, now, step) for name, value in metrics.items()]
        tags = [self._entities.RunTag(STEP_TAG, str(step))]
        self._client.log_batch(self._run, metrics=points, tags=tags)
        self._last = step

    def end(self, status: Status) -> None:
        """Report how the run ended."""
        self._client.set_terminated(self._run, status=STATUS[status])

    def _make(self, name: str) -> str:
        title = os.environ.get("MLFLOW_EXPERIMENT_NAME", EXPERIMENT)
        experiment = self._client.get_experiment_by_name(title)
        number = (
            self._client.create_experiment(title)
            if experiment is None
            else experiment.experiment_id
        )
        return self._client.create_run(number, run_name=name).info.run_id


def flat(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield (dotted key, value as text) of nested values."""
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield prefix + key, str(value)
