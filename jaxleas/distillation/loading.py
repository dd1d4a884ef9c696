"""Reading the configuration of a distillation: what it does not state suits the robot."""

from functools import reduce
from pathlib import Path
from typing import Any

from jaxleas.configuration import layers_of, load_layers, merge
from jaxleas.distillation.config import DistillationConfig, SteeringRun
from jaxleas.envs.steering import SteeringConfig
from jaxleas.runs import RunFolder
from jaxleas.training import load_run_config
from jaxleas.types import InputError


def load_distillation(path: str | Path, start: Path | None = None) -> DistillationConfig:
    """Return the configuration of a distillation that a YAML file states.

    What it does not state suits the robot, as in a training: the run's heights and terrain, and the
    terrain of practice, where one is given.

    Args:
        path: the YAML file.
        start: run folder of the policy to begin with, whose robot practises; None: the robot is
            that of the run that the configuration states.

    Raises:
        InputError: the configuration is invalid, or `start` is not the folder of a steering run.
    """
    layers = layers_of(path)
    stated = reduce(merge, (values for _, values in layers))
    suited = {"run": SteeringConfig.suited(_section(stated, "run", "env"))}
    practised = suited["run"] if start is None else _sizes_of(start)
    if "terrain" in practised and _section(stated, "practice", "terrain"):
        suited["practice"] = {"terrain": practised["terrain"]}
    (source, weakest), *others = layers
    return load_layers(DistillationConfig, [(source, merge(suited, weakest)), *others])


def first_run(config: DistillationConfig, start: Path | None) -> SteeringRun:
    """Return the configuration of the run that is begun with, or is yet to be trained.

    Args:
        config: configuration of the distillation.
        start: run folder of the policy to begin with, if one is given.

    Raises:
        InputError: `start` is not a run folder.
    """
    return config.run if start is None else load_steering_run(RunFolder.open(start).config)


def load_steering_run(path: Path) -> SteeringRun:
    """Return the configuration of a steering run.

    Args:
        path: the run folder's YAML file.

    Raises:
        InputError: it cannot be read, or belongs to another task.
    """
    config: Any = load_run_config(path)
    if not isinstance(config.env, SteeringConfig):
        raise InputError(f"{path} is a run of the task {config.env.task}; one of steering would do")
    return config


def _sizes_of(start: Path) -> dict[str, Any]:
    """Return values that suit the robot of a run."""
    config = load_steering_run(RunFolder.open(start).config)
    return SteeringConfig.suited({"robot": config.env.robot})


def _section(stated: Any, *names: str) -> dict[str, Any]:
    """Return a section inside others; an empty one where it is not stated."""
    for name in names:
        stated = stated.get(name) if isinstance(stated, dict) else None
    return stated if isinstance(stated, dict) else {}
