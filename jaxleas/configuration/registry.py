"""Plugs: built-in items by name, and the user's own as MODULE:CLASS."""

import difflib
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, TypeVar

from jaxleas.configuration.own_code import describe
from jaxleas.types import InputError

Item = TypeVar("Item")


class Registry(Generic[Item]):
    """The one place that names a kind of plug, such as tasks, planners or conditions.

        SHAPES = Registry("shape", {"box": "jaxleas.geometry:Box"})

    A built-in item is imported on request, so that a list of names costs nothing and an item may
    live in any room.

    Attributes:
        kind: name of the kind of item, for messages: "task", "planner".
        targets: MODULE:NAME of each built-in item.
    """

    def __init__(
        self,
        kind: str,
        targets: Mapping[str, str],
        require: Callable[[str, Any], None] = lambda name, item: None,
    ) -> None:
        """Name the built-in items.

        Args:
            kind: name of the kind of item.
            targets: MODULE:NAME of each built-in item.
            require: function that is called with name and item of the user's own; it raises
                InputError if the item is not of this kind.
        """
        self.kind = kind
        self.targets = dict(targets)
        self._require = require

    def __iter__(self) -> Iterator[str]:
        """Yield the names of the built-in items."""
        return iter(self.targets)

    def __contains__(self, name: object) -> bool:
        """Return whether an item of this name is built in."""
        return name in self.targets

    def find(self, name: str, allow: Collection[str] = ()) -> Item:
        """Return an item: a built-in one, or the user's own if its code may be run.

        Args:
            name: name of a built-in item, or MODULE:CLASS.
            allow: user's own code that may be run, as MODULE:CLASS, named on a command line or in
                a call. A name that comes from a file alone is never imported.

        Raises:
            InputError: there is no such item, its code may not be run, or it is of another kind.
        """
        if name in self.targets:
            module, _, attribute = self.targets[name].partition(":")
            return getattr(import_module(module), attribute)
        if not is_own(name):
            raise InputError(f"there is no {self.kind} {name!r}{self.hint(name)}")
        if name not in allow:
            raise InputError(
                f"the {self.kind} {name} is code: if you trust it, give --allow {name} on the"
                f" command line{misspelt(name, allow)}"
            )
        if (here := str(Path.cwd())) not in sys.path:
            sys.path.append(here)  # where the user's own modules are
        item = load(name, self.kind)
        self._require(name, item)
        return item

    def hint(self, name: str) -> str:
        """Return the end of a message about an unknown name: the nearest right one, and all."""
        close = difflib.get_close_matches(name, self.targets, n=1)
        meant = f"; perhaps you meant {close[0]}" if close else ""
        return f"{meant}; there are {self.describe()}"

    def describe(self) -> str:
        """Return the list of names that an item can have."""
        return f"{', '.join(self.targets)}, or MODULE:CLASS of your own"


def is_own(name: str) -> bool:
    """Return whether a name is that of the user's own class, MODULE:CLASS."""
    return ":" in name


def misspelt(name: str, allow: Collection[str]) -> str:
    """Return the end of a message about code that may not be run: a name like it that may."""
    close = difflib.get_close_matches(name, allow, n=1)
    return f"; you allowed {close[0]}: is one of the two misspelt?" if close else ""


def load(target: str, kind: str) -> Any:
    """Import MODULE:NAME.

    This runs code: call it for names that the user gave, never for names from a file alone.

    Raises:
        InputError: there is no such module or name.
    """
    module, _, name = target.partition(":")
    try:
        found = import_module(module)
    except (ImportError, ValueError) as error:
        raise InputError(
            f"the {kind} {target} cannot be loaded: {error}; give MODULE:CLASS of a module in this"
            " folder or one that is installed"
        ) from error
    except Exception as error:
        raise InputError(
            f"the {kind} {target} cannot be loaded: its module raises {describe(error)}"
        ) from error
    if not hasattr(found, name):
        close = difflib.get_close_matches(name, vars(found), n=1)
        meant = f"; perhaps you meant {module}:{close[0]}" if close else ""
        raise InputError(
            f"the {kind} {target} cannot be loaded: module {module!r} has no attribute {name!r}"
            f"{meant}; give MODULE:CLASS of a module in this folder or one that is installed"
        )
    return getattr(found, name)
