"""A population's folder.

population.json     the members' configurations and the evolution, resolved
member_00/          run folder of member 0, an ordinary one
checkpoints/        the state of all members
history.jsonl       one line a round of evolution: scores, parents, values
lock                held while a process trains
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from jaxleas.files import read_json, write_json
from jaxleas.sweeps.folder import hold, require_vacant
from jaxleas.sweeps.population_config import Members
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
        mine = {"version": VERSION, **_plain(members)}
        if not record.is_file():
            write_json(record, mine)
        if read_json(record) != mine:
            raise InputError(
                f"{path} holds another population, {record}: give its file, or another --out"
            )
        yield [path / f"member_{number:02d}" for number in range(len(members.configs))]
    finally:
        os.close(lock)


def _plain(members: Members) -> dict[str, Any]:
    return {
        "seed": members.seed,
        "evolution": members.evolution and members.evolution.model_dump(mode="json"),
        "vary": {name: each.model_dump(mode="json") for name, each in members.space.items()},
        "members": [config.model_dump(mode="json") for config in members.configs],
    }
