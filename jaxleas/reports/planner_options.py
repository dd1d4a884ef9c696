"""Which exact planners an evaluation asks, and by which settings, as options state them."""

from collections.abc import Collection, Sequence
from typing import Any

from jaxleas.contacts import PLANNERS, PlannerSettings, find_planner, settings_from
from jaxleas.types import InputError


def planner_names(suite: str, given: Sequence[str] | None) -> tuple[str, ...]:
    """Return the names of the planners to ask.

    Args:
        suite: name of the suite that is walked.
        given: names as given; None: the suite's own.

    Raises:
        InputError: there is no such planner.
    """
    names = words(given)
    if names is None:
        thesis = (name for name in PLANNERS if find_planner(name).in_thesis)
        return tuple(thesis) if suite == "thesis" else ()
    if names == ["none"]:
        return ()
    for name in names:
        find_planner(name, [name])
    return tuple(dict.fromkeys(names))


def planner_settings(
    planners: Sequence[str], given: dict[str, Any], named: Collection[str]
) -> dict[str, PlannerSettings]:
    """Return the settings of each planner: those given that it has.

    Args:
        planners: names of the planners.
        given: all settings given, by name.
        named: names of those given as --parameters, of which a planner must have each.

    Raises:
        InputError: no planner has one of the named settings, or a value is out of range.
    """
    found = {name: find_planner(name, [name]) for name in planners}
    known = {name: each.settings.model_fields for name, each in found.items()}
    for name in named:
        if not any(name in fields for fields in known.values()):
            judges = (
                f"none of the planners {', '.join(planners)} has"
                if planners
                else "no planner judges and has"
            )
            raise InputError(f"--parameters {name}: {judges} such a setting")
    return {
        name: settings_from(
            each, **{key: value for key, value in given.items() if key in known[name]}
        )
        for name, each in found.items()
    }


def words(given: Sequence[str] | None) -> list[str] | None:
    """Return what was given as words or separated by commas; None where nothing was."""
    if given is None:
        return None
    return [word for text in given for word in text.split(",") if word]
