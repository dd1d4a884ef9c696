"""The run configuration that trainings of a sweep or a population start from."""

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from jaxleas.configuration import require_field, with_values
from jaxleas.files import config_file
from jaxleas.training import RunConfig, load_run_config, pinned


def load_base(
    path: Path, config: str, changes: Mapping[str, Any], allow: Collection[str] = ()
) -> RunConfig:
    """Return the run configuration that a file names, with the fields that it changes for all.

    Args:
        path: path of the file.
        config: path of the run configuration, relative to the file, or name of a shipped one.
        changes: values by the dotted names of fields: the file's key `set`.
        allow: user's own code that may be run, as MODULE:CLASS.

    Raises:
        InputError: the configuration is invalid, or has no such field.
    """
    base = pinned(load_run_config(config_file(config, path.parent), allow=allow))
    for name in changes:
        require_field(type(base), name, f"{path}: set")
    return with_values(base, changes, f"{path}: set")
