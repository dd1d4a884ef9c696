"""A sweep's study in Optuna: new or continued; it gives out trials one number at a time."""

import time
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Any

from jaxleas.configuration import to_yaml
from jaxleas.files import read_json, require_version, typed
from jaxleas.sweeps.border import Sweep
from jaxleas.sweeps.draw import draw
from jaxleas.sweeps.folder import SweepFolder
from jaxleas.sweeps.objectives import is_maximised
from jaxleas.sweeps.results import VERSION, TrialResult
from jaxleas.sweeps.storage import open_storage, require_optuna
from jaxleas.types import InputError

OWNER, SWEEP, RESULT = "owner", "sweep", "result"  # attributes of trials and study
DRAWING = 5.0
"""Time for which a trial without an owner may be one that another machine is drawing [s]."""


class Study:
    """All trials of a sweep; several machines may share one through a storage.

    Every trial has one number below `trials` and is reported once: a trial that was drawn but not
    reported is continued by the machine that drew it.
    """

    def __init__(self, sweep: Sweep, folder: SweepFolder, storage: str | None) -> None:
        """Make the study, or continue it.

        Raises:
            InputError: the storage cannot be used, or holds another sweep of this name.
        """
        self._optuna = require_optuna()
        self.sweep, self._owner = sweep, folder.owner
        self._shared = storage is not None
        directions = [
            "maximize" if is_maximised(each) else "minimize" for each in sweep.config.objectives
        ]
        try:
            self._study = self._optuna.create_study(
                study_name=sweep.name,
                storage=open_storage(storage, folder.journal),
                directions=directions,
                pruner=_pruner(self._optuna, sweep),
                load_if_exists=True,
            )
            self._require_same(storage)
        except (InputError, KeyboardInterrupt):
            raise
        except Exception as error:
            where = storage or folder.journal
            raise InputError(f"the storage {where} cannot be used: {error}") from error

    def _require_same(self, storage: str | None) -> None:
        mine = to_yaml(self.sweep.config.model_copy(update={"trials": 1, "parallel": 1}))
        theirs = self._study.user_attrs.get(SWEEP)
        if theirs is None:
            self._study.set_user_attr(SWEEP, mine)
        elif theirs != mine:
            raise InputError(
                f"the storage {storage or 'of this folder'} holds another sweep called"
                f" {self.sweep.name}: rename the file, or name another storage"
            )

    def open_trials(self) -> list[Any]:
        """Return the trials that this machine drew and has not reported yet, by number."""
        trials = self._running()
        ours = [each for each in trials if each.user_attrs.get(OWNER, self._owner) == self._owner]
        # A trial without an owner was being drawn when its machine was killed. It is ours if the
        # storage is not shared; otherwise the machine that takes it first continues it.
        opened = []
        for each in ours:
            if each.number < self.sweep.config.trials:
                self._choose_sampler(each.number)
                opened.append(self._optuna.trial.Trial(self._study, each._trial_id))
        return opened

    def _running(self) -> list[Any]:
        """Return the trials that run, when no other machine is about to draw one's values."""
        state = self._optuna.trial.TrialState.RUNNING
        end = time.monotonic() + (DRAWING if self._shared else 0.0)
        while True:
            trials = self._study.get_trials(deepcopy=False, states=(state,))
            if all(OWNER in each.user_attrs for each in trials) or time.monotonic() >= end:
                return trials
            time.sleep(0.05)

    def ask(self) -> Any | None:
        """Return a new trial; None when all numbers have been given out."""
        trials, given = self.sweep.config.trials, len(self._study.get_trials(deepcopy=False))
        if given >= trials:
            return None
        self._choose_sampler(given)
        trial = self._study.ask()
        if trial.number >= trials:  # two machines asked at once
            self._study.tell(trial, state=self._optuna.trial.TrialState.FAIL)
            return None
        return trial

    def _choose_sampler(self, number: int) -> None:
        """Draw each trial from its own random stream: the same after a resume, never used twice."""
        config = self.sweep.config
        self._study.sampler = _sampler(self._optuna, config.sampler, config.seed + 7919 * number)

    def draw(self, trial: Any) -> dict[str, Any]:
        """Return a trial's values, and mark it as ours."""
        if trial.user_attrs.get(OWNER) != self._owner:
            trial.set_user_attr(OWNER, self._owner)
        return draw(trial, self.sweep)

    def reported(self, trial: Any) -> int:
        """Return the number of examinations of a trial that were reported before."""
        return len(self._study.get_trials(deepcopy=False)[trial.number].intermediate_values)

    def report(self, trial: Any, examination: int, success: float) -> bool:
        """Report one examination of a trial's learning curve; return whether to prune it."""
        trial.report(success, examination)
        return trial.should_prune()

    def tell(self, trial: Any, result: TrialResult) -> None:
        """End a trial with its result."""
        states = self._optuna.trial.TrialState
        state = {"done": states.COMPLETE, "pruned": states.PRUNED, "failed": states.FAIL}
        trial.set_user_attr(RESULT, asdict(result))
        values = None
        if result.state == "done":
            values = [result.values[each.name] for each in self.sweep.config.objectives]
        self._study.tell(trial, values, state=state[result.state])

    def results(self) -> list[TrialResult]:
        """Return the results of all machines, by number.

        Raises:
            InputError: the storage holds a value that is not a result.
        """
        reported = [
            typed(TrialResult, each.user_attrs[RESULT], f"trial {each.number} of the storage")
            for each in self._study.get_trials(deepcopy=False)
            if each.state.is_finished() and RESULT in each.user_attrs
        ]
        return sorted(reported, key=lambda result: result.number)

    def importance(self) -> dict[str, float]:
        """Return the importance of each searched field for the first objective, by PED-ANOVA.

        It is empty if there are too few trials, or all are equally good.
        """
        objectives = self.sweep.config.objectives
        sign = -1.0 if is_maximised(objectives[0]) else 1.0
        target = None if len(objectives) == 1 else lambda trial: sign * trial.values[0]
        evaluator = self._optuna.importance.PedAnovaImportanceEvaluator()
        try:
            with warnings.catch_warnings(action="ignore"):  # about few trials: the report says so
                return self._optuna.importance.get_param_importances(
                    self._study, evaluator=evaluator, target=target
                )
        except (ValueError, RuntimeError):
            return {}


def read_results(folder: Path) -> list[TrialResult]:
    """Read a sweep's results.json.

    Raises:
        InputError: the file is missing or not the results of a sweep.
    """
    path = Path(folder) / "results.json"
    content = read_json(path)
    trials = content.get("trials") if isinstance(content, dict) else None
    if isinstance(content, dict):
        require_version(content, VERSION, path)
    return typed(list[TrialResult], trials, f"{path} holds no results of a sweep")


def _sampler(optuna: Any, kind: str, seed: int) -> Any:
    samplers = optuna.samplers
    if kind == "random":
        return samplers.RandomSampler(seed=seed)
    return samplers.TPESampler(seed=seed, multivariate=True, group=True, constant_liar=True)


def _pruner(optuna: Any, sweep: Sweep) -> Any:
    config, base = sweep.config, sweep.base
    if config.pruner == "median":
        return optuna.pruners.MedianPruner(n_startup_trials=config.startup_trials)
    if config.pruner == "hyperband":
        examinations = -(-base.ppo.updates // base.held_out.every)
        return optuna.pruners.HyperbandPruner(min_resource=1, max_resource=max(2, examinations))
    return optuna.pruners.NopPruner()
