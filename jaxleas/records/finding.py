"""Finding the run folders below a folder."""

import os
from collections.abc import Iterator
from pathlib import Path

DEPTH = 5
"""Depth of the search: a sweep's trials and a distillation's rounds are two or three deep."""
MARKS = ("provenance.json", "lock")
"""Files of a run: training makes the second one first and the first one last, and nothing else
makes either."""


def find_runs(folder: str | Path) -> list[Path]:
    """Return the run folders at or below a folder, whole or not, by name.

    Args:
        folder: folder to search; hidden folders are skipped, links are followed once.
    """
    return sorted(_runs(Path(folder), DEPTH, set()))


def _runs(folder: Path, depth: int, seen: set[Path]) -> Iterator[Path]:
    if (whole := folder.resolve()) in seen:
        return
    seen.add(whole)
    if any((folder / mark).is_file() for mark in MARKS):
        yield folder
        return
    if depth == 0:
        return
    try:
        with os.scandir(folder) as entries:
            inner = sorted(entry.name for entry in entries if entry.is_dir())
    except OSError:  # no permission to read it
        return
    for name in inner:
        if not name.startswith("."):
            yield from _runs(folder / name, depth - 1, seen)
