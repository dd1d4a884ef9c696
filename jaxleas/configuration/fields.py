"""The fields of a configuration model: dotted names, suggestions for typos, and help texts."""

import difflib
import types
import typing
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo


@dataclass(frozen=True)
class Field:
    """One field of a model, or of a model inside it.

    Attributes:
        name: dotted name, as in `ppo.learning_rate`.
        info: pydantic's description of the field.
        section: model that the field holds, if it holds one.
    """

    name: str
    info: FieldInfo
    section: type[BaseModel] | None


def fields_of(model: type[BaseModel], prefix: str = "") -> Iterator[Field]:
    """Yield every field of `model`, those of nested models after the field that holds them."""
    for key, info in model.model_fields.items():
        section = _section(info.annotation)
        yield Field(prefix + key, info, section)
        if section is not None:
            yield from fields_of(section, f"{prefix}{key}.")


def nearest(name: str, names: Collection[str]) -> str | None:
    """Return the entry of `names` that `name` probably stands for, if any is close.

    The last part of the dotted name decides, so that `learning_rate` at the top level finds
    `ppo.learning_rate`; between equals, the whole name decides.
    """

    def likeness(candidate: str) -> tuple[float, float]:
        return _ratio(_last(name), _last(candidate)), _ratio(name, candidate)

    # A section is not a suggestion for a wrong field in it.
    others = [candidate for candidate in names if not name.startswith(f"{candidate}.")]
    best = max(others, key=likeness, default=None)
    return best if best is not None and likeness(best)[0] >= 0.6 else None


def help_text(model: type[BaseModel], config: BaseModel) -> str:
    """Return one paragraph per field: `--name`, its type, its value in `config`, its docstring."""
    lines = ["Every field of the configuration can be set on the command line:", ""]
    for field in fields_of(model):
        if field.section is not None and _value(config, field.name) is not None:
            continue
        value = _value(config, field.name)
        lines.append(f"  --{field.name} {_type_name(field.info.annotation)}  [{value}]")
        if field.info.description:
            lines.append("        " + " ".join(field.info.description.split()))
    return "\n".join(lines)


def _section(annotation: Any) -> type[BaseModel] | None:
    """Return the model of an annotation: itself, or the one in an optional or annotated type."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated):
        found = [_section(inner) for inner in typing.get_args(annotation)]
        return next((section for section in found if section is not None), None)
    return None


def _value(config: Any, name: str) -> Any:
    for part in name.split("."):
        config = getattr(config, part, None)
    return config


def _type_name(annotation: Any) -> str:
    if typing.get_origin(annotation) is typing.Literal:
        return "|".join(str(value) for value in typing.get_args(annotation))
    origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _type_name(inner[0])
    if origin in (typing.Union, types.UnionType):
        return "|".join(map(_type_name, inner))
    if origin is not None:
        return f"[{', '.join(map(_type_name, inner))}]"
    return "..." if annotation is Ellipsis else getattr(annotation, "__name__", str(annotation))


def _ratio(one: str, other: str) -> float:
    return difflib.SequenceMatcher(None, one, other).ratio()


def _last(name: str) -> str:
    return name.rpartition(".")[2]


def meant(name: str, names: Collection[str]) -> str:
    """Return the end of a message about a wrong name: the nearest of `names`, if one is near."""
    close = nearest(name, names)
    return "" if close is None else f"; perhaps you meant {close}"


def hint(name: str, names: list[str], dashes: int = 0) -> str:
    """Return the end of a message about an unknown field: the nearest of `names`, or all."""
    close = nearest(name, names)
    if close is not None:
        return f"; perhaps you meant {'-' * dashes}{close}"
    section = name.rpartition(".")[0]
    prefix = f"{section}." if any(each.startswith(f"{section}.") for each in names) else ""
    there = [each for each in names if each.startswith(prefix) and "." not in each[len(prefix) :]]
    return f"; there are {', '.join(there)}"
