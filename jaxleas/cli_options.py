"""Command-line options from a function's signature and docstring."""

import argparse
import inspect
import types
import typing
from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from typing import Any


def add_options(parser: argparse.ArgumentParser, function: Callable[..., Any]) -> None:
    """Add the parameters of a function to a parser.

    The first parameter, if it may be given by position and has no default, becomes a positional
    argument, and so does everything before a `*`; every other parameter an option `--its-name`,
    required if it has no default. A parameter that is a dataclass becomes one option per field;
    one with a `*` becomes none (`takes_further`).

    Args:
        parser: parser that gets the options, and its description from the docstring's first line.
        function: function annotated with numbers, text, paths, booleans, literals, and optional or
            sequence types of these; the help of an `Annotated[str, REGISTRY]` lists its names.
    """
    text = inspect.getdoc(function) or ""
    parser.description = text.partition("\n\n")[0]
    helps = _helps(text, "Args")
    hints = typing.get_type_hints(function, include_extras=True)
    parameters = list(inspect.signature(function).parameters.values())
    starred = any(each.kind is each.KEYWORD_ONLY for each in parameters)
    for index, parameter in enumerate(parameters):
        name = parameter.name
        if parameter.kind is parameter.VAR_POSITIONAL:
            continue  # what the parser does not know
        if is_dataclass(hints.get(name)):
            _add_group(parser, hints[name])
            continue
        options = _options_of_type(hints.get(name, str))
        required = parameter.default is parameter.empty
        words = [helps.get(name, ""), *options.pop("names", ())]
        options["help"] = " ".join(filter(None, words)).replace("%", "%%")
        positional = parameter.kind is not parameter.KEYWORD_ONLY and (starred or index == 0)
        if positional and required:
            parser.add_argument(name, metavar=name.upper(), **options)
            continue
        if positional and starred:
            if parameter.default is not None:
                options["help"] += f" [{parameter.default}]".replace("%", "%%")
            options |= {"nargs": "?", "default": parameter.default}
            parser.add_argument(name, metavar=name.upper(), **options)
            continue
        if not required:
            _state_default(options, parameter.default)
        parser.add_argument(_flag(name), dest=name, required=required, **options)


def takes_further(function: Callable[..., Any]) -> bool:
    """Return whether a function takes options that its signature does not name."""
    parameters = inspect.signature(function).parameters.values()
    return any(each.kind is each.VAR_POSITIONAL for each in parameters)


def arguments_of(function: Callable[..., Any], given: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of a function from what `add_options` made a parser read.

    Args:
        function: function that the options were made of.
        given: values by option, as the parser returned them.
    """
    values = dict(vars(given))
    for name, hint in typing.get_type_hints(function).items():
        if name != "return" and is_dataclass(hint) and isinstance(hint, type):
            values[name] = hint(**{each.name: values.pop(each.name) for each in fields(hint)})
    return values


def _add_group(parser: argparse.ArgumentParser, group: Any) -> None:
    """Add the fields of a dataclass, all of which have defaults, as options."""
    helps = _helps(inspect.getdoc(group) or "", "Attributes")
    hints = typing.get_type_hints(group, include_extras=True)
    for each in fields(group):
        options = _options_of_type(hints[each.name])
        options["help"] = helps.get(each.name, "").replace("%", "%%")
        _state_default(options, each.default)
        parser.add_argument(_flag(each.name), dest=each.name, **options)


def _flag(name: str) -> str:
    return "--" + name.strip("_").replace("_", "-")


def _state_default(options: dict[str, Any], default: Any) -> None:
    options["default"] = default
    if default not in (None, False, ()):
        options["help"] += f" [{default}]".replace("%", "%%")


def _options_of_type(annotation: Any) -> dict[str, Any]:
    """Return argparse's options for a parameter of this type."""
    origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
    if annotation is bool:
        return {"action": argparse.BooleanOptionalAction}
    if origin is typing.Literal:
        return {"choices": inner, "type": type(inner[0])}
    if origin is typing.Annotated:
        options = _options_of_type(inner[0])
        parsers = [each.parse for each in inner[1:] if hasattr(each, "parse")]
        options |= {"type": parsers[0]} if parsers else {}
        # A registry says what can be named; importing its class here would load NumPy for --help.
        listed = [f"({each.describe()})" for each in inner[1:] if hasattr(each, "describe")]
        return options | {"names": listed} if listed else options
    if origin in (typing.Union, types.UnionType):
        return _options_of_type(_plainest([each for each in inner if each is not type(None)]))
    if origin is tuple and Ellipsis not in inner:
        return {**_options_of_type(inner[0]), "nargs": len(inner)}
    if inspect.isclass(origin) and issubclass(origin, Sequence):
        return {**_options_of_type(inner[0]), "nargs": "+", "action": _Gather}
    return {"type": annotation if inspect.isclass(annotation) else str}


class _Gather(argparse.Action):
    """Keep all values of an option, however often it is given; the first replace its default."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        del parser, option_string
        before = getattr(namespace, self.dest)
        given = () if before is self.default else before
        setattr(namespace, self.dest, [*given, *values])


def _plainest(members: list[Any]) -> Any:
    """Return the member of a union that arguments are parsed as: for `str | Path` either works."""
    return next((each for each in members if each is not str), str)


def _helps(docstring: str, section: str) -> dict[str, str]:
    """Return the sentences under `Args:` or `Attributes:` in a docstring, by name."""
    _, found, rest = docstring.partition(f"\n{section}:\n")
    helps: dict[str, str] = {}
    name = ""
    for line in rest.splitlines() if found else ():
        if line and not line.startswith(" "):
            break  # the next section
        if line.startswith("    ") and not line.startswith("     "):
            name, _, text = line.strip().partition(":")
            helps[name] = text.strip()
        elif name and line.strip():
            helps[name] += " " + line.strip()
    return helps
