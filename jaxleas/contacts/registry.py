"""The one place where contact planners are named."""

import re
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any

from jaxleas.configuration import Registry, is_own, meant, misspelt
from jaxleas.contacts.own_planner import JudgedByOwn, OwnPlanner
from jaxleas.contacts.planner import Measure, Planner
from jaxleas.types import InputError


def _require_planner(name: str, item: Any) -> None:
    if not (isinstance(item, type) and issubclass(item, OwnPlanner | Planner)):
        raise InputError(
            f"{name} is not a planner: derive a class from jaxleas.labels.OwnPlanner and give it"
            " judge(scene, path)"
        )


PLANNERS: Registry[type[Planner] | type[OwnPlanner]] = Registry(
    "planner",
    {
        "sampling": "jaxleas.contacts.sampling_planner:Sampling",
        "mip": "jaxleas.contacts.programs.mip:Mip",
        "sl1m": "jaxleas.contacts.programs.sl1m:Sl1m",
        "astar": "jaxleas.contacts.search.astar:Astar",
    },
    _require_planner,
)
DEFAULT_JUDGE = "sampling"
"""Name of the planner that judges guide paths by default."""
DEFAULT_PLANNER = "mip"
"""Name of the planner that plans single problems and guide paths by default."""
PlannerName = Annotated[str, PLANNERS]
"""Type of a command's option: its help lists the planners."""


def find_planner(name: str, allow: Collection[str] = ()) -> Planner:
    """Return the planner of that name.

    Args:
        name: name of a planner, or MODULE:CLASS of the user's own.
        allow: each MODULE:CLASS that a person has named on a command line or in a call; what only
            a file names is never imported.

    Raises:
        InputError: there is no such planner, or its code may not be run.
    """
    kind = PLANNERS.find(name, allow)
    return JudgedByOwn(name, kind) if issubclass(kind, OwnPlanner) else kind(name)


def title_of(name: str, allow: Collection[str] = ()) -> str:
    """Return a planner's title; its name for the user's own, which may no longer exist.

    Args:
        name: name of the planner.
        allow: planners of the user's own that may be imported for their title.
    """
    known = name in PLANNERS or name in allow
    return (find_planner(name, allow).title if known else "") or name


def measures_of(name: str) -> frozenset[Measure]:
    """Return a planner's measures; for one of the user's own, which may no longer exist, none."""
    return find_planner(name).measures if name in PLANNERS else frozenset()


def permit(
    config: Path, planner: str, said: str | None, allow: Collection[str] = ()
) -> tuple[str, ...]:
    """Return the code that may be imported where a file names a planner.

    Args:
        config: file that names the planner.
        planner: name of the planner in the file.
        said: name of the planner given on the command line, which permits it as --allow does.
        allow: code given with --allow.

    Raises:
        InputError: the planner is code and was not given on the command line, or another was.
    """
    if said is not None and said != planner:
        raise InputError(f"{config} asks for the planner {planner}, not for {said}")
    permitted = tuple(allow) if said is None else (*allow, said)
    if is_own(planner) and planner not in permitted:
        raise InputError(
            f"{config} asks for the planner {planner}, which is code: if you trust it, give"
            f" --allow {planner}{misspelt(planner, permitted)}"
        )
    return permitted


def require_planner_name(name: str) -> str:
    """Return a name that may be a planner's; for configurations, whose code is permitted later.

    Raises:
        ValueError: no planner can have this name.
    """
    if name in PLANNERS or re.fullmatch(r"[\w.]+:\w+", name):
        return name
    raise ValueError(f"there is no planner {name!r}{PLANNERS.hint(name)}")


def require_built_in(name: str) -> str:
    """Return the name of a planner that needs no permission.

    Raises:
        ValueError: the name is not a built-in planner's.
    """
    if name not in PLANNERS:
        near = meant(name, PLANNERS.targets)
        raise ValueError(
            f"there is no planner {name!r} here{near}; there are {', '.join(PLANNERS)}"
        )
    return name
