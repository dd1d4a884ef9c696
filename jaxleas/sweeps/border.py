"""Checks of a whole sweep file against the run configuration, before anything runs."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jaxleas.configuration import (
    load_config,
    present_name,
    with_values,
)
from jaxleas.contacts import settings_from
from jaxleas.envs import TASKS
from jaxleas.evaluation import SUITED_TASKS, make_suite
from jaxleas.sweeps.base import load_base
from jaxleas.sweeps.config import Exact, SweepConfig, TimeToSuccess
from jaxleas.sweeps.space import check_conditions, check_dimension
from jaxleas.training import (
    RunConfig,
    require_signature,
    swept_fields,
)
from jaxleas.types import InputError


@dataclass(frozen=True)
class Sweep:
    """A checked sweep, which can run.

    Attributes:
        source: path of its file, for messages.
        config: configuration of the sweep, as stated.
        base: run configuration that trials start from.
        whole: names of the searched fields that hold whole numbers.
        vectorised: whether trials train together in one program.
        allow: user's own code that may be run, as MODULE:CLASS.
    """

    source: str
    config: SweepConfig
    base: RunConfig
    whole: frozenset[str]
    vectorised: bool
    allow: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the study in a storage."""
        return Path(self.source).stem

    def run_config(self, values: Mapping[str, Any], seed: int) -> RunConfig:
        """Return a training's configuration.

        Args:
            values: values of the searched fields.
            seed: seed of the training.

        Raises:
            InputError: the values do not fit each other.
        """
        return with_values(self.base, {**values, "seed": seed}, "the trial")


def open_sweep(path: str | Path, allow: Collection[str] = ()) -> Sweep:
    """Read a sweep's file and the configuration it names.

    Args:
        path: path of the file.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the value is invalid; the message names the file, the key, and what would do.
    """
    path = Path(path)
    config = load_config(SweepConfig, path)
    base = load_base(path, config.config, config.set, allow)
    return check_sweep(config, base, str(path), allow)


def check_sweep(
    config: SweepConfig, base: RunConfig, source: str, allow: Collection[str] = ()
) -> Sweep:
    """Return the checked sweep of a configuration.

    Args:
        config: configuration of the sweep, as stated.
        base: run configuration that trials start from.
        source: name of the file, with which error messages begin.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the space names a field that cannot be searched, or an objective cannot be
            measured.
    """
    require_signature(base)
    whole = frozenset(
        name
        for name, dimension in config.space.items()
        if check_dimension(name, dimension, base, f"{source}: space")
    )
    check_conditions(config.space, source)
    for index, objective in enumerate(config.objectives):
        if isinstance(objective, Exact):
            _check_exact(objective, base, f"{source}: objectives.{index}")
    on_host = TASKS.find(base.env.task, allow).on_host
    vectorised = _vectorised(config, base, source, on_host)
    return Sweep(source, config, base, whole, vectorised, tuple(allow))


def _check_exact(objective: Exact, base: RunConfig, where: str) -> None:
    if base.env.task not in SUITED_TASKS:
        raise InputError(
            f"{where}: exact planners judge {', '.join(SUITED_TASKS)}, not the task"
            f" {base.env.task}: measure held_out"
        )
    try:
        settings_from(objective.planner, **objective.parameters)
        for name in objective.suites:
            make_suite(name, objective.starts, held_out=True)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _vectorised(config: SweepConfig, base: RunConfig, source: str, on_host: bool) -> bool:
    """Return whether trials train in one program; raise if that is requested but impossible."""
    swept = swept_fields(base.env)
    other = next(
        (name for name in config.space if present_name(type(base), name) not in swept), None
    )
    timed = any(
        isinstance(each, TimeToSuccess) and each.measure == "seconds_to_success"
        for each in config.objectives
    )
    if config.vectorised == "auto":
        alone = on_host or timed or bool(base.begin)
        return other is None and config.pruner == "none" and not alone
    if not config.vectorised:
        return False
    if on_host:
        raise InputError(
            f"{source}: vectorised is true, but the task {base.env.task} steps on the host, one"
            " training at a time: leave vectorised out"
        )
    if base.begin:
        raise InputError(
            f"{source}: vectorised is true, but trials of one program begin untrained: leave"
            " vectorised out, or begin"
        )
    if other is not None:
        raise InputError(
            f"{source}: vectorised is true, but space.{other} is another program for every value:"
            " leave vectorised out, or that field"
        )
    if config.pruner != "none":
        raise InputError(
            f"{source}: vectorised is true, but pruner = {config.pruner} ends single trials, and"
            " those of one program end together: leave one of them out"
        )
    if timed:
        raise InputError(
            f"{source}: vectorised is true, but seconds_to_success needs trials that train alone:"
            " steps_to_success would do"
        )
    return True
