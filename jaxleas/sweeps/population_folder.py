"""A population's folder.

population.json     the members' configurations and the evolution, resolved
member_00/          run folder of member 0, an ordinary one
checkpoints/        the state of all members
history.jsonl       one line a round of evolution: scores, parents, values
lock                held while a process trains
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from jaxleas.files import read_json, write_json
from jaxleas.sweeps.folder import hold, require_vacant
from jaxleas.sweeps.population_config import Members
from jaxleas.training.config import RunConfig
from jaxleas.types.errors import InputError

VERSION = 1
RECORD = "population.json"


@contextmanager
def hold_population(path: Path, members: Members) -> Iterator[list[Path]]:
    """Make a population's folder, or go on in it; yield the members' run folders.

    Raises:
        InputError: it is something else's, another population's, or held by another process.
    """
    record = path / RECORD
    if not record.is_file():
        require_vacant(path, {"lock"}, "population")
    lock = hold(path)
    try:
        if not record.is_file():
            write_json(record, {"version": VERSION, **_plain(members)})
        if _read(record) != _read_plain(_plain(members)):
            raise InputError(
                f"{path} holds another population, {record}: give its file, or another --out"
            )
        yield [path / f"member_{number:02d}" for number in range(len(members.configs))]
    finally:
        lock.close()


def _plain(members: Members) -> dict[str, Any]:
    return {
        "seed": members.seed,
        "evolution": members.evolution and members.evolution.model_dump(mode="json"),
        "vary": {name: each.model_dump(mode="json") for name, each in members.space.items()},
        "members": [config.model_dump(mode="json") for config in members.configs],
    }


def _read(record: Path) -> Any:
    """Return what a record means: fields that are newer than it have their defaults.

    Raises:
        InputError: it is of another version, or damaged.
    """
    content = read_json(record)
    if not isinstance(content, dict) or content.get("version") != VERSION:
        raise InputError(f"{record} is of another version; this one reads {VERSION}")
    try:
        return _read_plain({name: each for name, each in content.items() if name != "version"})
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{record} is no record of a population: {error}") from error


def _read_plain(content: dict[str, Any]) -> Any:
    configs = [RunConfig.model_validate_json(json.dumps(each)) for each in content["members"]]
    return configs, {name: each for name, each in content.items() if name != "members"}
