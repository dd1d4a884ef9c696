"""Lines, numbers and byte order marks of text files from strangers."""

from collections.abc import Callable, Iterator

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError

_MARK = b"\xef\xbb\xbf"


def without_mark(content: bytes) -> bytes:
    """Return text without the byte order mark that some editors put in front."""
    return content.removeprefix(_MARK)


def lines_of(content: bytes) -> Iterator[bytes]:
    """Yield the lines of a text, without the space around them."""
    return (line.strip() for line in content.splitlines())


def vectors(texts: list[bytes], broken: Callable[[str], InputError]) -> Float[np.ndarray, "N 3"]:
    """Return the first three numbers of each text; colours and weights may follow."""
    words = [text.split(None, 3)[:3] for text in texts]
    short = next((each for each in words if len(each) < 3), None)
    if short is not None:
        raise broken(f"the vertex {shown(b' '.join(short))} has fewer than 3 numbers")
    try:
        return np.array(words, dtype="S64").astype(np.float64).reshape(-1, 3)
    except ValueError as error:
        raise broken("a vertex is no three numbers") from error


def shown(text: bytes) -> str:
    """Return a piece of a file for a message."""
    return ascii(text.decode(errors="replace"))[:60]
