"""Conditions as a configuration names them."""

from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Field, Tag

from jaxleas.conditions.catalogue import CONDITIONS, SURROGATE
from jaxleas.configuration import Strict, is_own, misspelt
from jaxleas.files import digest_of

STANDARD = ("strict_reachability", "collision")
"""R* and C: the conditions by which every policy is judged (T 3.3.1)."""


class SurrogateSettings(Strict):
    """A contact planner's learned stand-in that also ends episodes."""

    surrogate: Annotated[str, Field(min_length=1)]
    """File written by `jaxleas fit`, relative to the working folder."""
    threshold: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.0
    """The risk dial: a walk ends where the planner gets this far with less than this probability; 0
    fails as often as the planner would."""
    sha256: str | None = None
    """Digest of the file, recorded when a run begins."""


def _kind(value: Any) -> str:
    return "surrogate" if isinstance(value, dict | SurrogateSettings) else "name"


Named = Annotated[
    Annotated[str, Tag("name")] | Annotated[SurrogateSettings, Tag("surrogate")],
    Discriminator(_kind),
]


def _require_known(named: tuple[Named, ...]) -> tuple[Named, ...]:
    """Refuse unknown names, several surrogates, and a surrogate alone."""
    names = [each for each in named if isinstance(each, str)]
    for name in names:
        if name == SURROGATE:
            raise ValueError("a surrogate needs its file: {surrogate: FILE}")
        if not is_own(name) and name not in CONDITIONS:
            raise ValueError(f"there is no condition {name!r}{CONDITIONS.hint(name)}")
    if not names:
        raise ValueError(
            f"a configuration must be judged by itself, too: give {', '.join(STANDARD)} as well"
        )
    if len(named) - len(names) > 1:
        raise ValueError("it names two surrogates, and an episode can follow one: leave one out")
    return named


NamedConditions = Annotated[tuple[Named, ...], Field(min_length=1), AfterValidator(_require_known)]
"""At least one name of a condition, and at most one surrogate."""


def pinned(named: tuple[Named, ...]) -> tuple[Named, ...]:
    """Return the same conditions, with the absolute path and digest of each file.

    Raises:
        InputError: a file is missing.
    """
    return tuple(
        each
        if isinstance(each, str)
        else each.model_copy(
            update={
                "surrogate": str(Path(each.surrogate).absolute()),
                "sha256": digest_of(each.surrogate),
            }
        )
        for each in named
    )


def harmless(named: tuple[Named, ...], allow: Collection[str] = ()) -> bool:
    """Return whether conditions are built in or allowed: neither other code nor a file.

    Args:
        named: conditions that a file states, which may be untrusted.
        allow: user's own code that may be run, as MODULE:CLASS.
    """
    return all(isinstance(each, str) and (each in CONDITIONS or each in allow) for each in named)


def words_of(named: tuple[Named, ...]) -> str:
    """Return conditions as a message lists them: each by its name, a surrogate by its file."""
    return ", ".join(each if isinstance(each, str) else each.surrogate for each in named)


def permission(named: tuple[Named, ...], allow: Collection[str] = ()) -> str:
    """Return the end of a warning: what would permit conditions that are not `harmless`.

    It is empty where a surrogate is among them: no option permits a file that another file names.

    Args:
        named: conditions that a file states.
        allow: user's own code that may be run, as MODULE:CLASS.
    """
    if not all(isinstance(each, str) for each in named):
        return ""
    missing = [str(each) for each in named if each not in CONDITIONS and each not in allow]
    hints = "".join(misspelt(each, allow) for each in missing)
    return f"; if you trust their code, give --allow {' '.join(missing)}{hints}"
