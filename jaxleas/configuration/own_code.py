"""Failures of the user's own code: one sentence that says what was raised, and where."""

import sysconfig
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any

from jaxleas.types import JaxleasError, OwnCodeError

LONGEST = 240
"""Longest part of another library's message that is repeated, in characters."""
_OURS = str(Path(__file__).resolve().parents[1])
_INSTALLED = (_OURS, sysconfig.get_paths()["stdlib"], sysconfig.get_paths()["purelib"])


@contextmanager
def own_code(what: str) -> Iterator[None]:
    """Turn every exception of a block that runs the user's own code into one sentence.

    Args:
        what: name of the code, with which the sentence begins.

    Raises:
        OwnCodeError: the block raised an exception that is not one of this package's.
    """
    try:
        yield
    except JaxleasError:
        raise
    except Exception as error:
        raise OwnCodeError(f"{what} raises {describe(error)}") from error


@contextmanager
def methods_of(owner: Any, name: str) -> Iterator[None]:
    """Turn exceptions that passed through methods of one object into one sentence each.

    Other exceptions, such as those of this package's own defects, keep their traceback.

    Args:
        owner: object whose methods are the user's own code.
        name: name of the object, with which the sentence begins.

    Raises:
        OwnCodeError: a method raised an exception that is not one of this package's.
    """
    try:
        yield
    except JaxleasError:
        raise
    except Exception as error:
        for frame, _ in traceback.walk_tb(error.__traceback__):
            if frame.f_locals.get("self") is owner:
                method = frame.f_code.co_name
                raise OwnCodeError(f"{name}: {method} raises {describe(error)}") from error
        raise


def describe(error: Exception) -> str:
    """Return type and message of an exception, and the last place in the user's files."""
    text = " ".join(str(error).strip().split("\n")[0].split())
    text = f"{text[:LONGEST]}..." if len(text) > LONGEST else text
    places = [
        f" ({Path(frame.f_code.co_filename).name}, line {line})"
        for frame, line in traceback.walk_tb(error.__traceback__)
        if _is_own(frame)
    ]
    named = type(error).__name__
    return (
        f"{named}{': ' if text else ''}{text}{places[-1] if places else ''}; --traceback shows more"
    )


def _is_own(frame: FrameType) -> bool:
    file = frame.f_code.co_filename
    outside = ("site-packages", "dist-packages", "<")
    return not file.startswith(_INSTALLED) and not any(part in file for part in outside)
