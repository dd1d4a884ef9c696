"""Rows of a binary PLY file: as one array where all lists are as long as those of the first row."""

from collections.abc import Callable
from typing import Any

import numpy as np

from jaxleas.terrain.meshes.ply_header import Broken, Columns, Element, joined


def rows_of_bytes(body: bytes, order: str, broken: Broken) -> Callable[[Element], Columns]:
    """Return a reader of the next rows, of one kind after another.

    Args:
        body: bytes after the header.
        order: byte order, "<" or ">".
        broken: makes the error of a reason why the file cannot be read.
    """
    at = 0

    def read(element: Element) -> Columns:
        nonlocal at
        counts = _first_counts(body, at, order, element, broken) if element.rows else {}
        parts: list[Any] = []
        for name, kind, count in element.properties:
            if count is not None:
                parts.append((f"{name} count", order + count))
            size = (counts.get(name, 0),)
            parts.append((name, order + kind) if count is None else (name, order + kind, size))
        if len({part[0] for part in parts}) < len(parts):
            raise broken("its header names a property twice")
        row = np.dtype(parts)
        end = at + element.rows * row.itemsize
        if end <= len(body):
            table = np.frombuffer(body, row, element.rows, at)
            if all((table[f"{name} count"] == number).all() for name, number in counts.items()):
                at = end
                return {
                    name: table[name]
                    if count is None
                    else (np.full(element.rows, counts.get(name, 0)), table[name].reshape(-1))
                    for name, _, count in element.properties
                }
        columns, at = _row_by_row(body, at, order, element, broken)
        return columns

    return read


def _first_counts(
    body: bytes, at: int, order: str, element: Element, broken: Broken
) -> dict[str, int]:
    """Return how long the lists in the first row are; most files have them all alike."""
    counts = {}
    for name, kind, count in element.properties:
        if count is not None:
            counts[name] = _number(body, at, order + count, broken)
            at += np.dtype(count).itemsize
        at += np.dtype(kind).itemsize * counts.get(name, 1)
    return counts


def _row_by_row(
    body: bytes, at: int, order: str, element: Element, broken: Broken
) -> tuple[Columns, int]:
    values: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
    kinds = [
        (name, np.dtype(order + kind), None if count is None else np.dtype(order + count))
        for name, kind, count in element.properties
    ]
    for _ in range(element.rows):
        for name, kind, count in kinds:
            number = 1
            if count is not None:
                number = _number(body, at, count, broken)
                at += count.itemsize
            if at + number * kind.itemsize > len(body):
                raise broken("it is cut short")
            values[name].append(np.frombuffer(body, kind, number, at))
            at += number * kind.itemsize
    return {name: joined(values[name], count) for name, _, count in kinds}, at


def _number(body: bytes, at: int, kind: Any, broken: Broken) -> int:
    size = np.dtype(kind).itemsize
    if at + size > len(body):
        raise broken("it is cut short")
    number = int(np.frombuffer(body, kind, 1, at)[0])
    if not 0 <= number <= len(body):
        raise broken("a list has an impossible length")
    return number
