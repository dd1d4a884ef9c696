"""A safe subset of YAML: no repeated keys, `3e-4` is a number, and only plain values."""

import os
import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from jaxleas.files import is_file, read_bytes
from jaxleas.types import InputError


class _Loader(yaml.SafeLoader):
    """Loader of plain values only; a key given twice is an error."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, Hashable) and key in seen:
                line = key_node.start_mark.line + 1
                raise yaml.constructor.ConstructorError(
                    problem=f"the key '{key}' is given twice, again in line {line}"
                )
            seen.add(key if isinstance(key, Hashable) else repr(key))
        return super().construct_mapping(node, deep)


class _Dumper(yaml.SafeDumper):
    """Dumper for `_Loader`: it quotes strings that look like `3e-4`, and writes no aliases."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


MAX_CHARACTERS = 1_000_000
MAX_DEPTH = 50
_OPENING = (
    yaml.BlockMappingStartToken,
    yaml.BlockSequenceStartToken,
    yaml.FlowMappingStartToken,
    yaml.FlowSequenceStartToken,
)
_CLOSING = yaml.FlowMappingEndToken | yaml.FlowSequenceEndToken

# YAML 1.1 takes `3e-4` for a string, since it has no dot; authors mean a number.
_EXPONENT = re.compile(r"^[-+]?[0-9][0-9_]*[eE][-+]?[0-9]+$")
for _each in (_Loader, _Dumper):
    _each.add_implicit_resolver("tag:yaml.org,2002:float", _EXPONENT, list("-+0123456789"))


def parse_yaml(text: str) -> Any:
    """Return the plain value that `text` states.

    Raises:
        ValueError: the text is not YAML, or gives one key twice.
    """
    try:
        _require_plain(text)
        # A SafeLoader: it makes plain values and never runs anything.
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, RecursionError, OverflowError, ValueError) as error:
        raise ValueError(_problem(error)) from error


def _require_plain(text: str) -> None:
    """Refuse text that would take disproportionate time or memory, before any value is made.

    Raises:
        ValueError: there is an alias (which can stand for millions of values), or the text is too
            long or nested too deep.
    """
    if len(text) > MAX_CHARACTERS:
        raise ValueError(f"it is longer than {MAX_CHARACTERS} characters")
    depth = 0
    for token in yaml.scan(text, Loader=yaml.SafeLoader):
        line = token.start_mark.line + 1
        if isinstance(token, yaml.AliasToken | yaml.AnchorToken):
            raise ValueError(f"anchors and aliases (& and *) are not read, as in line {line}")
        depth += isinstance(token, _OPENING) - isinstance(token, yaml.BlockEndToken | _CLOSING)
        if depth > MAX_DEPTH:
            raise ValueError(f"it nests more than {MAX_DEPTH} deep in line {line}")


def read_mapping(path: Path) -> dict[str, Any]:
    """Return the mapping that a YAML file holds.

    Raises:
        InputError: the file is missing, unreadable, not YAML, empty, or not a mapping.
    """
    if not is_file(path):
        what = "is a folder" if os.path.isdir(path) else "does not exist"
        raise InputError(f"the configuration file {path!s:.300} {what}")
    try:
        value = parse_yaml(read_bytes(path, 4 * MAX_CHARACTERS).decode("utf-8"))
    except ValueError as error:
        raise InputError(f"{path} is not a usable YAML file: {error}") from error
    if value is None:
        raise InputError(f"{path} is empty: a configuration states at least one `key: value`")
    if not isinstance(value, dict):
        raise InputError(
            f"{path} holds a {type(value).__name__}: a configuration is a mapping, `key: value`"
        )
    _require_text_keys(value, path)
    return value


def dump_yaml(value: dict[str, Any]) -> str:
    """Return `value` as YAML text that `parse_yaml` reads back as it is."""
    return yaml.dump(value, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100)


def _require_text_keys(value: Any, path: Path) -> None:
    """Refuse keys that are not text, text that is not Unicode, and numbers too large for fields."""
    if isinstance(value, str) and not value.isascii():
        try:
            value.encode()
        except UnicodeEncodeError as error:
            raise InputError(f"{path} holds text that is not Unicode: a lone surrogate") from error
    if isinstance(value, list):
        for inner in value:
            _require_text_keys(inner, path)
    if isinstance(value, int) and not -(2**63) <= value < 2**64:
        raise InputError(f"{path} holds a whole number of more than 64 bits")
    for key, inner in value.items() if isinstance(value, dict) else ():
        _require_text_keys(key, path)
        if not isinstance(key, str):
            raise InputError(f"{path}: the key {str(key)[:60]} is no name; write it in quotes")
        _require_text_keys(inner, path)


def _problem(error: Exception) -> str:
    if isinstance(error, yaml.MarkedYAMLError):
        mark = error.problem_mark
        where = f" in line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        return f"{error.problem or error.context}{where}"
    return " ".join(str(error).split())
