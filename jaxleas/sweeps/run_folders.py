"""Run folders that may already exist, complete or cut short by a kill."""

from collections.abc import Collection, Sequence
from pathlib import Path

from jaxleas.configuration import to_yaml
from jaxleas.runs import RunFolder
from jaxleas.training import RunConfig, load_run_config
from jaxleas.types import InputError

# Files of a run folder before the record that marks it as complete.
_BEGINNINGS = {"lock", "config.yaml", "provenance.diff"}


def hold_run_folder(
    path: Path, config: RunConfig, command: Sequence[str], allow: Collection[str] = ()
) -> RunFolder:
    """Make a training's run folder, or open an existing one, and hold it for writing.

    A folder whose making was cut short is made again.

    Args:
        path: path of the folder.
        config: configuration of the training.
        command: command line that started it.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the folder belongs to another run, or is in use.
    """
    if not (path / "provenance.json").is_file():
        if path.is_dir():
            _clear_beginnings(path)
        return RunFolder.create(path, to_yaml(config), command)
    run = RunFolder.open(path, writing=True, needs_checkpoint=False)
    if load_run_config(run.config, allow=allow) != config:
        run.close()
        raise InputError(f"{path} is the run folder of another configuration")
    return run


def _clear_beginnings(path: Path) -> None:
    names = {entry.name for entry in path.iterdir()}
    ours = {name for name in names if name in _BEGINNINGS or name.startswith(".")}
    if names == ours:
        for name in names - {"lock"}:
            (path / name).unlink()
