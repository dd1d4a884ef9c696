"""Watchers by name."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType

from jaxleas.configuration import meant
from jaxleas.runs.watching.watcher import Watcher
from jaxleas.types import InputError

# Name -> (required client, module here, class). Each is imported only on request: the clients take
# seconds.
WATCHERS = {
    "tensorboard": ("tensorboardX", "tensorboard_files", "TensorBoardWatcher"),
    "wandb": ("wandb", "wandb_run", "WandbWatcher"),
    "mlflow": ("mlflow", "mlflow_run", "MlflowWatcher"),
}


def require_watchers(names: Sequence[str]) -> None:
    """Refuse watchers that are not available, before anything is computed or written.

    Raises:
        InputError: there is no such watcher, a client is not installed, or its settings do not
            work.
    """
    for name in names:
        if name not in WATCHERS:
            near = meant(name, WATCHERS)
            raise InputError(
                f"watch: there is no watcher {name!r}{near}; there are {', '.join(WATCHERS)}"
            )
        client, _, _ = WATCHERS[name]
        try:
            module = import_module(client)
        except ImportError as error:
            raise InputError(
                f"watch: {name} needs the extra: pip install 'jaxleas[{name}]', or leave it out"
            ) from error
        check = getattr(_module(name), "require_usable", None)
        if check is not None:
            check(module)


def open_watchers(names: Sequence[str], folder: str | Path) -> dict[str, Watcher]:
    """Return watchers of a run folder, not begun yet.

    Raises:
        InputError: a client is not installed, or its settings do not work.
    """
    require_watchers(names)
    return {name: getattr(_module(name), WATCHERS[name][2])(Path(folder)) for name in names}


def _module(name: str) -> ModuleType:
    return import_module(f"jaxleas.runs.watching.{WATCHERS[name][1]}")
