"""What each exact planner can be told when it judges guide paths: part of a label's provenance."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt, ValidationError

from jaxleas.configuration.strict import Strict
from jaxleas.configuration.yaml_text import parse_yaml
from jaxleas.contacts.from_guide import EVERY, WINDOW, Candidates
from jaxleas.contacts.problem import Model
from jaxleas.contacts.sampling import SamplingSettings
from jaxleas.contacts.sl1m import MAX_COMBINATIONS
from jaxleas.contacts.slack_weights import SlackWeights
from jaxleas.labels.own_planner import OwnPlanner, is_own, load_planner
from jaxleas.types.errors import InputError


class PhaseSettings(Strict):
    """How a guide path becomes a contact problem (T 5.2.3), and how long a planner may take."""

    keep_every: PositiveInt = EVERY
    """one guide configuration in so many becomes a step, N_ref"""
    model: Model = "two_com"
    """two_com (with the centre of mass) or feet"""
    candidates: Candidates = "window"
    """surfaces in a window around the root, or in the moving leg's range of motion"""
    window: Annotated[float, Field(gt=0.0, lt=100.0)] = WINDOW
    """edge of the window [m]"""
    first_foot: Literal["LF", "RF"] = "LF"
    """which moves first"""
    time_limit: PositiveFloat = 60.0
    """for one guide path [s]; when it is over, the verdict is undecided"""


class MipSettings(PhaseSettings):
    """Settings of the mixed-integer planner."""


class Sl1mSettings(PhaseSettings):
    """Settings of SL1M."""

    max_combinations: NonNegativeInt = MAX_COMBINATIONS
    """of surfaces for the undecided steps, after which it gives up; 0: without that heuristics"""
    weights: SlackWeights = "uniform"
    """of the slacks: uniform, as published, or guide: the guide path chooses among surfaces"""


PlannerSettings = SamplingSettings | MipSettings | Sl1mSettings | OwnPlanner
SETTINGS: dict[str, type[PlannerSettings]] = {
    "sampling": SamplingSettings,
    "mip": MipSettings,
    "sl1m": Sl1mSettings,
}
"""The exact planners that can be asked for labels, each with the kind of its settings."""


def kind_of(planner: str) -> type[PlannerSettings]:
    """Return the kind of a planner's settings; a planner of one's own is its own settings.

    Raises:
        InputError: there is no such planner.
    """
    if is_own(planner):
        return load_planner(planner)
    if planner not in SETTINGS:
        raise InputError(
            f"there is no planner {planner!r} for labels; there are {', '.join(SETTINGS)}, and"
            " MODULE:CLASS of your own"
        )
    return SETTINGS[planner]


def require_settings(planner: str, settings: PlannerSettings | None) -> PlannerSettings:
    """Return the settings of a planner: those given, if they are its own, or its defaults.

    Raises:
        InputError: there is no such planner, or the settings are another's.
    """
    kind = kind_of(planner)
    if settings is None:
        return kind()
    if type(settings) is not kind:
        raise InputError(
            f"the {planner} planner takes {kind.__name__}, not {type(settings).__name__}"
        )
    return settings


def settings_from(planner: str, **given: Any) -> PlannerSettings:
    """Return a planner's settings with what is given; None means the planner's own default.

    Raises:
        InputError: the planner has no such setting, or the value is out of range.
    """
    kind = type(require_settings(planner, None))
    chosen = {name: value for name, value in given.items() if value is not None}
    unknown = next((name for name in chosen if name not in kind.model_fields), None)
    if unknown is not None:
        owners = [name for name, each in SETTINGS.items() if unknown in each.model_fields]
        if owners:
            option = unknown.replace("_", "-")
            words = f"--{option} is for the planner {' and '.join(owners)}, not for {planner}"
        else:
            words = f"{planner} has no setting {unknown}; it has {', '.join(kind.model_fields)}"
        raise InputError(words)
    try:
        return kind(**chosen)
    except ValidationError as error:
        first = error.errors()[0]
        option = str(first["loc"][0]).replace("_", "-")
        raise InputError(f"--{option} {first['input']}: {first['msg'].lower()}") from error


def seed_of(settings: PlannerSettings) -> NonNegativeInt | None:
    """Return the seed that a planner draws from; None for one that draws nothing."""
    return getattr(settings, "seed", None)


def settings_of(words: Sequence[str]) -> dict[str, Any]:
    """Return settings written as NAME=VALUE, values as in YAML.

    Raises:
        InputError: a word is no such pair.
    """
    settings = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not (name.isidentifier() and equals):
            raise InputError(f"--parameters {word}: they look like longest_step=0.3")
        try:
            settings[name] = parse_yaml(text)
        except ValueError as error:
            raise InputError(f"--parameters {word}: {text} is not YAML") from error
    return settings
