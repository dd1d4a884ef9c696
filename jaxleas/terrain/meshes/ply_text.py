"""Rows of a PLY file of text."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from jaxleas.terrain.meshes.ply_header import Broken, Columns, Element, joined


def rows_of_text(body: bytes, broken: Broken) -> Callable[[Element], Columns]:
    """Return a reader of the next rows, of one kind after another.

    Args:
        body: text after the header.
        broken: makes the error of a reason why the file cannot be read.
    """
    words = iter(body.split())

    def read(element: Element) -> Columns:
        lists = [name for name, _, count in element.properties if count is not None]
        try:
            if not lists:
                width = len(element.properties)
                table = np.array(list(_taken(words, element.rows * width, broken)), "S32")
                numbers = table.astype(np.float64).reshape(element.rows, width)
                return {each[0]: numbers[:, at] for at, each in enumerate(element.properties)}
            values: dict[str, list[Any]] = {name: [] for name, _, _ in element.properties}
            for _ in range(element.rows):
                for name, _, count in element.properties:
                    number = 1 if count is None else int(next(_taken(words, 1, broken)))
                    if not 0 <= number <= len(body):
                        raise broken("a list has an impossible length")
                    values[name].append([float(word) for word in _taken(words, number, broken)])
        except ValueError as error:
            raise broken(f"it holds something that is no number: {str(error)[:60]}") from error
        return {name: joined(values[name], count) for name, _, count in element.properties}

    return read


def _taken(words: Iterator[bytes], number: int, broken: Broken) -> Iterator[bytes]:
    for _ in range(number):
        word = next(words, None)
        if word is None:
            raise broken("it is cut short")
        yield word
