"""How guide paths ended, apart from what a planner makes of them."""

from collections import Counter
from collections.abc import Iterable
from typing import Literal

from jaxleas.types.paths import GuidePath

Ending = Literal["reached", "invalid", "stopped", "unknown"]
"""How a guide path ended: at its goal, at a configuration that is not valid, elsewhere, or valid
throughout in a file that does not say more."""


ENDINGS: dict[Ending, str] = {
    "reached": "reached their goal",
    "invalid": "ended invalid",
    "stopped": "stopped before their goal",
    "unknown": "of files that do not say how they ended",
}
"""A description of each ending, for several paths."""


def ending_of(path: GuidePath, said: str) -> Ending:
    """Return how a guide path ended.

    Args:
        path: guide path.
        said: what its file says; empty where it says nothing.
    """
    if said == "invalid" or not path.valid.all():
        return "invalid"
    known: dict[str, Ending] = {ending: ending for ending in ENDINGS}
    return known.get(said, "unknown")


def describe_endings(endings: Iterable[Ending]) -> str:
    """Return how several guide paths ended, as part of a sentence.

    Args:
        endings: how each of them ended.
    """
    count = Counter(endings)
    return ", ".join(f"{count[each]} {words}" for each, words in ENDINGS.items() if count[each])
