"""Which folders below a folder are runs."""

import os
from collections.abc import Iterator
from pathlib import Path

DEPTH = 5
"""Folders in folders: a sweep's trials and a distillation's rounds lie two or three deep."""
MARKS = ("provenance.json", "lock")
"""A training makes the second first and the first last; nothing else makes either."""


def find_runs(folder: str | Path) -> list[Path]:
    """Return the run folders at or below a folder, whole or not, by name.

    Args:
        folder: to look in; hidden folders are passed over, links are followed once.
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
    except OSError:  # not ours to read
        return
    for name in inner:
        if not name.startswith("."):
            yield from _runs(folder / name, depth - 1, seen)
