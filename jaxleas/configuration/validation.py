"""One validation of all that files and the command line state, with one sentence for a mistake."""

import json
import re
from typing import Any, TypeVar

from pydantic import ValidationError

from jaxleas.configuration.fields import fields_of, hint, meant
from jaxleas.configuration.former import with_present_names
from jaxleas.configuration.layers import Layers, merge
from jaxleas.configuration.strict import Strict
from jaxleas.types import InputError

Model = TypeVar("Model", bound=Strict)


def validate(model: type[Model], layers: Layers) -> Model:
    """Return the configuration that layers state together, given the weakest first.

    Raises:
        InputError: the value is invalid; the message names the layer, the key, and what would do.
    """
    layers = [(label, with_present_names(model, layer, label)) for label, layer in layers]
    stated: dict[str, Any] = {}
    for _, layer in layers:
        stated = merge(stated, layer)
    try:
        # Strict, as JSON: a list may become a tuple and a text a path, but "3" is never a number.
        return model.model_validate_json(json.dumps(stated, default=str), strict=True)
    except ValidationError as error:
        first, *others = error.errors()
        more = f" (and {len(others)} more)" if others else ""
        raise InputError(_sentence(model, layers, first) + more) from error


def _sentence(model: type[Strict], layers: Layers, error: Any) -> str:
    """Return an error of pydantic as one sentence with its source."""
    parts = [str(part) for part in error["loc"]]
    name = ".".join(parts)
    source = next(
        (label for label, layer in reversed(layers) if _states(layer, parts)), layers[0][0]
    )
    problem = error["msg"].removeprefix("Value error, ").replace("Input should", "it should")
    if error["type"] == "extra_forbidden":
        names = [field.name for field in fields_of(model)]
        return f"{source}: there is no {name}{hint(name, names)}"
    if error["type"].startswith("union_tag"):  # the field that selects a kind of section
        tag = f"{name}.{error['ctx']['discriminator'].strip(chr(39))}"
        kinds = error["ctx"].get("expected_tags")
        if kinds is None:
            return f"{source}: {tag} is missing and has no default"
        return f"{source}: {tag} is {error['ctx']['tag']!r}, but it should be one of {kinds}"
    if error["type"] == "too_short":
        least = error["ctx"]["min_length"]
        return f"{source}: {name} is {error['input']!r}, but it should hold at least {least}"
    if error["type"] == "missing":
        return f"{source}: {name} is missing and has no default"
    if isinstance(error["input"], dict) or not parts:  # a rule about several fields at once
        return f"{source}: {f'{name}: ' if name else ''}{problem}"
    if error["type"] == "literal_error":
        problem += meant(str(error["input"]), re.findall("'([^']+)'", error["ctx"]["expected"]))
    return f"{source}: {name} is {error['input']!r}, but {problem}"


def _states(layer: Any, parts: list[str]) -> bool:
    for part in parts:
        if isinstance(layer, list):
            return True  # lists are replaced whole
        if not isinstance(layer, dict) or part not in layer:
            return False
        layer = layer[part]
    return True
