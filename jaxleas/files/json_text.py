"""JSON from untrusted sources: parsed within bounds, or refused with a sentence."""

import json
import math
from typing import Any, NoReturn

from jaxleas.types import InputError

MAX_JSON_BYTES = 64 * 2**20
MAX_CONTAINERS = 4_000_000
"""Largest number of `[` and `{` in the text (strings count, too): objects and lists cost most
memory. With both bounds no file takes more than about a gigabyte."""
MAX_DEPTH = 100
MAX_DIGITS = 18  # in an integer, so that it fits into 64 bits


def parse_json(text: bytes | str, where: str) -> Any:
    """Return the value that JSON holds; all its numbers are finite, all its text is Unicode.

    Args:
        text: JSON text, in UTF-8 if bytes.
        where: name of the file, for messages.

    Raises:
        InputError: the text is not JSON, too large, nested too deep, or holds an unreasonable
            number.
    """
    if len(text) > MAX_JSON_BYTES:
        raise InputError(
            f"{where} is {len(text)} bytes of JSON, more than the {MAX_JSON_BYTES} read"
        )
    if isinstance(text, bytes):
        try:
            text = text.decode("utf-8-sig")  # some editors put a byte order mark in front
        except UnicodeDecodeError as error:
            raise InputError(
                f"{where} is not valid JSON: {error.reason} at {error.start}"
            ) from error
    if text.count("[") + text.count("{") > MAX_CONTAINERS:
        raise InputError(f"{where} holds more than {MAX_CONTAINERS} lists and objects")
    try:
        value = json.loads(
            text,
            parse_constant=lambda name: _refuse(where, name),
            parse_float=lambda digits: _float(where, digits),
            parse_int=lambda digits: _integer(where, digits),
        )
    except json.JSONDecodeError as error:
        raise InputError(f"{where} is not valid JSON: {error}") from error
    except RecursionError as error:
        raise InputError(f"{where} is not valid JSON: it nests too deep") from error
    _require_plain(value, where, surrogates="\\u" in text)
    return value


def _float(where: str, digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        _refuse(where, digits)
    return value


def _integer(where: str, digits: str) -> int:
    if len(digits) > MAX_DIGITS + 1:
        _refuse(where, digits)
    return int(digits)


def _refuse(where: str, number: str) -> NoReturn:
    shown = number if len(number) <= 20 else f"{number[:17]}..."
    raise InputError(f"{where} holds {shown}, which is neither JSON nor a usable number")


def _require_plain(value: Any, where: str, surrogates: bool) -> None:
    """Refuse values nested too deep, and text with lone surrogates (it could not be written)."""
    layer, depth = [value], 0
    while layer:
        if depth > MAX_DEPTH:
            raise InputError(f"{where} nests lists and objects more than {MAX_DEPTH} deep")
        inner: list[Any] = []
        for each in layer:
            if isinstance(each, dict):
                inner.extend(each.values())
                if surrogates:
                    inner.extend(each.keys())
            elif isinstance(each, list):
                inner.extend(each)
            elif surrogates and isinstance(each, str):
                _require_unicode(each, where)
        if not surrogates:  # then only containers matter
            inner = [each for each in inner if isinstance(each, dict | list)]
        layer, depth = inner, depth + 1


def _require_unicode(text: str, where: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise InputError(f"{where} holds text that is not Unicode: a lone surrogate") from error
