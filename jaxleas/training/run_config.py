"""Reading the configuration of a run: its task determines what its sections hold."""

from collections.abc import Collection, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any, cast

from jaxleas.configuration import (
    Layers,
    is_own,
    layers_of,
    load_layers,
    merge,
    own_code,
    validate,
)
from jaxleas.envs import DEFAULT_TASK, TASKS, Task, TaskConfig
from jaxleas.training.config import RunConfig
from jaxleas.types import InputError

AnyRun = RunConfig[Any, Any]


def load_run_config(
    path: str | Path, overrides: Sequence[str] = (), allow: Collection[str] = ()
) -> AnyRun:
    """Return the configuration of a run that a YAML file and the command line state together.

    What neither states suits the task, for example its robot (`TaskConfig.suited`).

    Args:
        path: the YAML file.
        overrides: command-line arguments such as `--ppo.discount 0.97` (`load_config`).
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the configuration is invalid; one sentence names the file (or the command
            line), the key, what was given, and what would do.
    """
    layers = layers_of(path)
    strongest_first = [("command line", _stated_env(overrides)), *reversed(layers)]
    model = _model(strongest_first, allow)
    return load_layers(model, _suited(model, strongest_first, layers), overrides)


def parse_run_config(document: Any, source: str, allow: Collection[str] = ()) -> AnyRun:
    """Return the configuration of a run that plain JSON values state.

    Args:
        document: mapping of the sections.
        source: name of the document, with which error messages begin.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the value is invalid; the message names the source, the key, and what would do.
    """
    layers = [(source, document if isinstance(document, dict) else {})]
    return validate(_model(layers, allow), layers)


def run_config_of(task: str, allow: Collection[str] = ()) -> type[AnyRun]:
    """Return the type of a task's run configurations.

    Raises:
        InputError: there is no such task, or its code may not be run.
    """
    found = TASKS.find(task, allow)
    return RunConfig[found.Config, found.Worlds]  # type: ignore[name-defined]


def make_task(config: AnyRun, allow: Collection[str] = ()) -> Task:
    """Return the task of a run.

    Raises:
        InputError: there is no such task, its code may not be run, or it cannot be made.
    """
    found = TASKS.find(config.env.task, allow)
    with own_code(f"the task {config.env.task}") if is_own(config.env.task) else nullcontext():
        return found.make(config.env, config.terrain, allow)


def require_signature(config: AnyRun) -> None:
    """Refuse a user's own task that has no signature; nothing of JAX is touched.

    Raises:
        InputError: the signature cannot be made.
    """
    with own_code(f"the task {config.env.task}: signature"):
        config.env.signature()


def pinned(config: AnyRun) -> AnyRun:
    """Return the configuration with each file by its absolute path and its digest.

    Raises:
        InputError: a file is missing.
    """
    sections = {"terrain": config.terrain.pinned(), "env": config.env.pinned()}
    return config.model_copy(update=sections)


def _model(strongest_first: Layers, allow: Collection[str]) -> type[AnyRun]:
    for source, stated in strongest_first:
        section = stated.get("env")
        if isinstance(section, dict) and isinstance(section.get("task"), str):
            try:
                return run_config_of(section["task"], allow)
            except InputError as error:
                raise InputError(f"{source}: env.task: {error}") from error
    return run_config_of(DEFAULT_TASK)


def _suited(model: type[AnyRun], strongest_first: Layers, layers: Layers) -> Layers:
    """Return the layers, the weakest completed by what suits the task that they state."""
    sections = [each["env"] for _, each in strongest_first if isinstance(each.get("env"), dict)]
    env = cast(type[TaskConfig], model.model_fields["env"].annotation)
    suited = env.suited({key: value for each in reversed(sections) for key, value in each.items()})
    (source, weakest), *others = layers
    return [(source, merge(suited, weakest)), *others]


def _stated_env(overrides: Sequence[str]) -> dict[str, Any]:
    """Return the texts of options `--env.FIELD VALUE`."""
    env = {}
    for index, option in enumerate(overrides):
        name, equals, value = option.partition("=")
        if name.startswith("--env."):
            value = value if equals else next(iter(overrides[index + 1 : index + 2]), "")
            env[name.removeprefix("--env.")] = value
    return {"env": env} if env else {}
