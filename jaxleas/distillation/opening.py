"""Begin a distillation's folder: its configuration, and the policy to begin with."""

from collections.abc import Collection
from pathlib import Path

from jaxleas.configuration import load_config, to_yaml
from jaxleas.contacts import find_planner, settings_from
from jaxleas.distillation.config import DistillationConfig
from jaxleas.distillation.folder import VERSION, DistillationFolder, read_begun_with
from jaxleas.distillation.loading import load_steering_run
from jaxleas.files import write_json, write_text
from jaxleas.runs import RunFolder
from jaxleas.training import Devices, make_task, train
from jaxleas.types import InputError


def open_folder(
    folder: DistillationFolder,
    config: DistillationConfig,
    start: Path | None,
    allow: Collection[str] = (),
) -> DistillationConfig:
    """Write the configuration and the location of the initial policy, or continue in a folder.

    Args:
        folder: folder of the distillation.
        config: configuration of the distillation.
        start: run folder of the policy to begin with, if one is given.
        allow: user's own code that may be run, as MODULE:CLASS: planner and conditions.

    Raises:
        InputError: the folder belongs to something else, or to a distillation with another
            configuration or another policy to begin with; the planner's parameters cannot be used;
            `start` is not a run folder; or without it, the run's task cannot be made.
    """
    planner = find_planner(config.planner, allow)
    settings_from(planner, **config.parameters)
    settings_from(planner, **config.labelling_parameters)
    if start is None:
        make_task(config.run, allow)
    else:
        RunFolder.open(start)
    where = None if start is None else str(Path(start).resolve())
    if folder.config.is_file():
        if load_config(DistillationConfig, folder.config) != config:
            raise InputError(
                f"{folder.path} is a distillation with another configuration, {folder.config}:"
                " give that one, or another --out"
            )
        begun_with = read_begun_with(folder.begun_with)
        if begun_with != where:
            raise InputError(
                f"{folder.path} was begun with {begun_with or 'a policy of its own'}, not with"
                f" {where or 'one of its own'}: give that --start, or another --out"
            )
        return config
    if folder.path.exists() and (not folder.path.is_dir() or any(folder.path.iterdir())):
        raise InputError(f"{folder.path} exists and is no distillation: give another --out")
    write_json(folder.begun_with, {"version": VERSION, "run": where})
    write_text(folder.config, to_yaml(config))
    return config


def train_start(
    folder: DistillationFolder,
    config: DistillationConfig,
    devices: Devices,
    allow: Collection[str] = (),
) -> Path:
    """Return the run folder of the policy to begin with, trained first where none was given.

    Args:
        folder: folder of the distillation.
        config: configuration of the distillation.
        devices: devices that share a training.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: this is not a distillation's folder.
    """
    where = read_begun_with(folder.begun_with)
    if where is not None:
        return Path(where)
    if (folder.start / "config.yaml").is_file():
        run = RunFolder.open(folder.start, writing=True, needs_checkpoint=False)
    else:
        run = RunFolder.create(folder.start, to_yaml(config.run), ["jaxleas", "distill"])
    with run:
        train(load_steering_run(run.config), run, devices=devices, allow=allow)
    return folder.start
