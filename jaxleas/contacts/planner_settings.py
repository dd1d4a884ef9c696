"""A planner's settings: selected from the given ones, and checked."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from jaxleas.configuration import Strict
from jaxleas.contacts.planner import Planner
from jaxleas.contacts.registry import PLANNERS, find_planner
from jaxleas.contacts.settings import PlannerSettings
from jaxleas.types import InputError


def require_settings(
    planner: Planner, settings: PlannerSettings | None, robot: str
) -> PlannerSettings:
    """Return the settings that a planner judges a robot's guide paths by, every one stated.

    Args:
        planner: planner that judges.
        settings: settings to use; the planner's defaults if None.
        robot: name of the robot.

    Raises:
        InputError: the settings are another planner's, or there is no such robot.
    """
    kind = planner.settings
    if settings is None:
        return kind().for_robot(robot)
    if type(settings) is not kind:
        raise InputError(
            f"the {planner.name} planner takes {kind.__name__}, not {type(settings).__name__}"
        )
    return settings.for_robot(robot)


def settings_from(planner: Planner | str, **given: Any) -> Any:
    """Return the settings that a planner judges by; None stands for its own default.

    Args:
        planner: planner, or name of a built-in one.
        given: settings by name.

    Raises:
        InputError: the planner has no such setting, or the value is out of range.
    """
    found = find_planner(planner) if isinstance(planner, str) else planner
    return _made(found.name, found.settings, given, lambda each: each.settings)


def stored_settings(planner: Planner | str, stored: Mapping[str, Any]) -> Any:
    """Return settings that a file of labels or of a surrogate has stored.

    A file stores all settings, also those that nobody stated: a value that is the default counts as
    not stated, so that it does not bind a robot which the default does not fit.

    Args:
        planner: planner, or name of a built-in one.
        stored: settings by name.

    Raises:
        InputError: the planner has no such setting, or the value is out of range.
    """
    found = find_planner(planner) if isinstance(planner, str) else planner
    default = found.settings().model_dump(mode="json")
    missing = object()
    return settings_from(
        found,
        **{name: each for name, each in stored.items() if default.get(name, missing) != each},
    )


def plan_settings_from(planner: Planner, **given: Any) -> Any:
    """Return the settings of a single plan; None stands for the planner's own default.

    Args:
        planner: planner that will plan.
        given: settings by name.

    Raises:
        InputError: the planner has no such setting, or the value is out of range.
    """
    return _made(planner.name, planner.plan_settings, given, lambda each: each.plan_settings)


def in_words(names: Sequence[str]) -> str:
    """Return names as a list in a sentence: a, b and c."""
    *others, last = names
    return f"{', '.join(others)} and {last}" if others else last


def _made(
    name: str, kind: type[Strict], given: dict[str, Any], kind_of: Callable[[Planner], type[Strict]]
) -> Strict:
    chosen = {field: value for field, value in given.items() if value is not None}
    unknown = next((field for field in chosen if field not in kind.model_fields), None)
    if unknown is not None:
        planners = map(find_planner, PLANNERS)
        owners = [each.name for each in planners if unknown in kind_of(each).model_fields]
        if owners:
            option = unknown.replace("_", "-")
            raise InputError(f"--{option} is for the planner {in_words(owners)}, not for {name}")
        known = ", ".join(kind.model_fields) or "none"
        raise InputError(f"{name} has no setting {unknown}; it has {known}")
    try:
        return kind(**chosen)
    except ValidationError as error:
        first = error.errors()[0]
        option = str(first["loc"][0]).replace("_", "-")
        raise InputError(f"--{option} {first['input']}: {first['msg'].lower()}") from error
