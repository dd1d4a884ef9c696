"""The commands `jaxleas runs` and `jaxleas compare`."""

import json as json_text
import shutil
from collections.abc import Callable, Sequence
from fnmatch import fnmatch
from pathlib import Path
from typing import Any, Literal

from jaxleas.configuration import meant, parse_yaml
from jaxleas.files import write_bytes, write_json, write_text
from jaxleas.records.comparison import compare_runs
from jaxleas.records.finding import find_runs
from jaxleas.records.listing import as_json, table
from jaxleas.records.record import RunRecord, State, defaults, read_record
from jaxleas.records.side_by_side import draw, plain, to_html, to_json
from jaxleas.types import InputError

_KEYS: dict[str, Callable[[RunRecord], Any]] = {
    "begun": lambda run: run.created,
    "name": lambda run: run.name,
    "state": lambda run: run.state,
    "steps": lambda run: run.steps,
    "held_out": lambda run: run.held_out,
    "success": lambda run: run.success,
    "time": lambda run: run.seconds,
}


def runs(
    folder: Path = Path("runs"),
    *,
    sort: Literal["begun", "name", "state", "steps", "held_out", "success", "time"] = "begun",
    reverse: bool = False,
    state: Sequence[State] | None = None,
    name: str | None = None,
    where: Sequence[str] | None = None,
    json: bool = False,
) -> None:
    """List the runs below a folder: their progress, success and configuration.

    Args:
        folder: folder to search; a sweep's trials and a distillation's rounds are found, too.
        sort: column to sort by; runs without a value in it come last.
        reverse: reverse the order.
        state: show only finished, running, interrupted or damaged runs.
        name: show only folders that match a pattern, such as 'leas_*'.
        where: show only runs with these settings, such as seed=1 ppo.discount=0.99.
        json: write plain values instead of the table.

    Raises:
        InputError: there is no such folder, or no such field to select by.
    """
    folder = Path(folder)
    if not folder.is_dir():
        what = f"{folder} is a file" if folder.exists() else f"the folder {folder} does not exist"
        raise InputError(f"{what}: give one that holds runs")
    wanted = _conditions(where or ())
    found = [read_record(path) for path in find_runs(folder)]
    shown = [
        run
        for run in found
        if (state is None or run.state in state)
        and (name is None or fnmatch(run.path.name, name) or fnmatch(str(run.path), name))
        and all(run.config.get(key, _MISSING) == value for key, value in wanted.items())
    ]
    shown = _sorted(shown, _KEYS[sort], reverse)
    if json:
        print(json_text.dumps([as_json(run) for run in shown], indent=2))
    elif shown:
        print(table(shown, folder, shutil.get_terminal_size((120, 24)).columns))
    else:
        some = f"none of the {len(found)} runs" if found else "no run"
        print(f"{some} under {folder} {'is so' if found else 'yet'}")


def compare(
    runs: Sequence[Path],
    *,
    json: Path | None = None,
    picture: Path | None = None,
    html: Path | None = None,
) -> None:
    """Compare runs side by side: differences in configuration and origin, curves, success.

    Args:
        runs: two or more run folders.
        json: file for the comparison as plain values.
        picture: file for a picture of the learning curves, .png.
        html: file for the whole comparison as one HTML page.

    Raises:
        InputError: there are fewer than two folders, or one of them is not a run folder.
    """
    if len(runs) < 2:
        raise InputError(f"there is only {runs[0]} to compare: give two run folders or more")
    records = [_require_run(Path(run)) for run in runs]
    comparison = compare_runs(records)
    print(plain(comparison))
    if json is not None:
        write_json(json, to_json(comparison))
    if picture is not None:
        write_bytes(picture, draw(comparison))
    if html is not None:
        write_text(html, to_html(comparison))
    for written in (json, picture, html):
        if written is not None:
            print(f"written: {written}")


_MISSING = object()


def _require_run(path: Path) -> RunRecord:
    if not path.is_dir():
        what = "is a file" if path.exists() else "does not exist"
        raise InputError(f"the run folder {path} {what}")
    if find_runs(path) != [path]:
        raise InputError(f"{path} is not a run folder: it holds no provenance.json")
    record = read_record(path)
    if record.state == "damaged":
        raise InputError(record.problem)
    return record


def _conditions(where: Sequence[str]) -> dict[str, Any]:
    known = [*defaults()]
    wanted = {}
    for each in where:
        key, equals, text = each.partition("=")
        if not equals:
            raise InputError(f"--where {each}: conditions look like ppo.discount=0.99")
        if key not in known:
            raise InputError(f"--where {each}: there is no field {key}{meant(key, known)}")
        try:
            wanted[key] = parse_yaml(text)
        except ValueError as error:
            raise InputError(f"--where {each}: {text} is not YAML: {error}") from error
    return wanted


def _sorted(
    records: Sequence[RunRecord], key: Callable[[RunRecord], Any], reverse: bool
) -> list[RunRecord]:
    known = [run for run in records if key(run) is not None]
    return sorted(known, key=key, reverse=reverse) + [run for run in records if key(run) is None]
