"""A population's folder.

population.json     the members' configurations and the evolution, resolved
member_00/          run folder of member 0, as of a single training
checkpoints/        the state of all members
history.jsonl       one line per round of evolution: scores, parents, values
lock                held while a process trains
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from pydantic import JsonValue, TypeAdapter

from jaxleas.files import read_typed, write_json
from jaxleas.sweeps.config import Dimension
from jaxleas.sweeps.evolution import EvolutionConfig
from jaxleas.sweeps.folder import hold, require_vacant
from jaxleas.sweeps.population_config import Members
from jaxleas.training import AnyRun, parse_run_config
from jaxleas.types import InputError

VERSION = 1
RECORD = "population.json"


@dataclass(frozen=True)
class _Record:
    """The resolved members of a population; fields newer than its file have their defaults."""

    seed: int
    evolution: EvolutionConfig | None
    vary: dict[str, Dimension]
    members: tuple[dict[str, JsonValue], ...]
    version: int = VERSION


@contextmanager
def hold_population(path: Path, members: Members) -> Iterator[list[Path]]:
    """Make a population's folder, or open an existing one; yield the members' run folders.

    Raises:
        InputError: the folder belongs to something else or another population, or is held by
            another process.
    """
    file = path / RECORD
    if not file.is_file():
        require_vacant(path, {"lock"}, "population")
    plain = tuple(each.model_dump(mode="json") for each in members.configs)
    record = _Record(members.seed, members.evolution, members.space, plain)
    lock = hold(path)
    try:
        if not file.is_file():
            write_json(file, TypeAdapter(_Record).dump_python(record, mode="json"))
        found = _read(file)
        if replace(found, members=plain) != record or _configs(file, found, members) != list(
            members.configs
        ):
            raise InputError(
                f"{path} holds another population, {file}: give its file, or another --out"
            )
        yield [path / f"member_{number:02d}" for number in range(len(members.configs))]
    finally:
        lock.close()


def _configs(file: Path, record: _Record, members: Members) -> list[AnyRun]:
    """Return a record's configurations; fields newer than its file have their defaults."""
    what = f"{file} is no record of a population"
    return [
        parse_run_config(each, f"{what}: members.{number}", members.allow)
        for number, each in enumerate(record.members)
    ]


def _read(file: Path) -> _Record:
    """Return the record in a file.

    Raises:
        InputError: the file is of another version, or damaged.
    """
    return read_typed(_Record, file, "record of a population", VERSION)
