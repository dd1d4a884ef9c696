"""A configuration that means the same wherever and whenever its run goes on."""

from jaxleas.conditions.named import pinned as pinned_conditions
from jaxleas.terrain.own_files import pinned as pinned_files
from jaxleas.training.config import RunConfig


def pinned(config: RunConfig) -> RunConfig:
    """Return the configuration with each file by its absolute path and its digest.

    A run folder keeps it in this form: a resumed run finds the files from any folder, and notices
    when one has changed.

    Raises:
        InputError: a file is missing.
    """
    files, conditions = config.terrain.files, config.env.conditions
    terrain = config.terrain.model_copy(update={"files": pinned_files(files)})
    env = config.env.model_copy(update={"conditions": pinned_conditions(conditions)})
    return config.model_copy(update={"terrain": terrain, "env": env})
