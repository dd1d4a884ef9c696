"""Mutations of a file: of its bytes, and of what texts hold (JSON, YAML, words)."""

import copy
import json
import random
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import yaml

Mutation = Callable[[random.Random, bytes], bytes]

_STRANGE: tuple[Any, ...] = (
    *(0, -1, 1, 2, 7, 255, 2**31, 2**63, -(2**63), 10**30, 10**400),
    *(1e308, -1e308, 1e-320, 0.5, 1e6),
    *(True, False, None, "", "x", "0", "1e9", "a" * 5000, "LF", "talos", "nan"),
    *("../../etc/passwd", "/dev/zero", "\u0000", "\ud800"),
    *([], {}, [[]], [None], [0] * 3, [1e9] * 3, {"": {}}, [[0, 0, 0]]),
)
_WORDS = (
    *(b"nan", b"inf", b"-1", b"0", b"99999999999999999999", b"1e999", b"1/2/3", b"1//", b"/", b""),
    *(b"\n", b"f 1 2 3\n", b"f 1\n", b"facet", b"mtllib /etc/passwd\n", b"\xff\xfe", b"x"),
)


def mutate_bytes(draw: random.Random, whole: bytes) -> bytes:
    """Return the bytes with some flipped, cut, repeated, blanked or replaced."""
    found = bytearray(whole)
    for _ in range(draw.choice((1, 1, 1, 2, 5, 20))):
        if not found:
            break
        at = draw.randrange(len(found))
        length = draw.choice((1, 2, 4, 8, 64, len(found) // 3 + 1))
        match draw.randrange(8):
            case 0 | 1:
                found[at] ^= 1 << draw.randrange(8)
            case 2:
                del found[at:]
            case 3:
                del found[at : at + length]
            case 4:
                found[at:at] = found[at : at + length]
            case 5:
                found[at : at + length] = bytes(len(found[at : at + length]))
            case 6:
                found[at : at + 4] = draw.choice((b"\xff" * 4, b"\0\0\0\x80", draw.randbytes(4)))
            case _:
                found[at : at + length] = draw.randbytes(min(length, 64))
    return bytes(found)


def splice(draw: random.Random, whole: bytes, other: bytes) -> bytes:
    """Return the beginning of one file and the end of another."""
    return whole[: draw.randrange(len(whole) + 1)] + other[draw.randrange(len(other) + 1) :]


def mutate_value(draw: random.Random, value: Any) -> Any:
    """Return a plain value with some of it deleted, swapped, renamed, or made something strange."""
    value = copy.deepcopy(value)
    for _ in range(draw.choice((1, 1, 1, 2, 4))):
        places = _places(value)
        if not places:
            return draw.choice(_STRANGE)
        parent, key = draw.choice(places)
        match draw.randrange(9):
            case 0:
                del parent[key]
            case 1 if isinstance(parent, dict):
                parent[draw.choice((key + "x", key.upper(), "version", "format", "extends"))] = (
                    parent.pop(key)
                )
            case 2:
                there, other = draw.choice(places)
                parent[key] = copy.deepcopy(there[other]) if _holds(there, other) else None
            case 3:
                parent[key] = [parent[key]]
            case 4 if isinstance(parent[key], list):
                parent[key] = parent[key] * draw.choice((0, 2, 50))
            case 5 if type(parent[key]) in (int, float):
                parent[key] *= draw.choice((-1, 0, 1e-9, 1e9, 1 + 1e-6, 1e300))
            case 6:
                parent[key] = _nested(draw.choice((3, 60, 150, 400)))
            case _:
                parent[key] = copy.deepcopy(draw.choice(_STRANGE))
    return value


def mutate_json(draw: random.Random, whole: bytes) -> bytes:
    """Return JSON with another value, sometimes with what JSON is not."""
    text = json.dumps(mutate_value(draw, json.loads(whole)))
    if draw.random() < 0.1:
        number = draw.choice(("NaN", "-Infinity", "1e999", "9" * 5000, "-0", "1E400", '"\\ud800"'))
        text = text.replace(draw.choice("0123456789"), number, 1)
    return text.encode(errors="surrogatepass")


def mutate_lines(draw: random.Random, whole: bytes) -> bytes:
    """Return JSON lines with one of them mutated."""
    lines = whole.splitlines()
    at = draw.randrange(len(lines))
    lines[at] = mutate_json(draw, lines[at])
    return b"\n".join(lines) + b"\n"


def mutate_yaml(draw: random.Random, whole: bytes) -> bytes:
    """Return YAML with another value, or with aliases, tags and merges."""
    evil = (
        "!!python/object/apply:os.system ['touch /tmp/owned']",
        "&a [x, x, x, x, x, x, x, x, x]\nb: &b [*a, *a, *a, *a, *a, *a]\nc: [*b, *b, *b, *b]",
        "&a [*a]",
        "{<<: {a: 1}}",
        "{? [1, 2] : 3}",
        "[{2020-01-01: 1}]",
        "[{.nan: 1}, {? {a: b} : c}]",
        "!!timestamp 2020-99-99",
        "!!binary aaa",
        "!!set {a, b}",
        "1:99999999999999999999:3",
        "0x" + "f" * 5000,
        "9" * 5000,
        ".inf",
        '"\\ud800"',
        "{" * 3000,
        "- " * 3000,
    )
    stated = _stated(whole)
    if draw.random() < 0.3:
        return (
            whole
            + f"\n{draw.choice(('seed', 'ppo', 'q', 'extends'))}: ".encode()
            + draw.choice(evil).encode(errors="surrogatepass")
        )
    value = mutate_value(draw, stated)
    try:
        return yaml.safe_dump(value).encode(errors="surrogatepass")
    except (RecursionError, ValueError):  # too deep, or a number of too many digits for PyYAML
        return json.dumps(value, default=str).encode()


@lru_cache(maxsize=64)
def _stated(whole: bytes) -> Any:
    return yaml.safe_load(whole)


def mutate_text(draw: random.Random, whole: bytes) -> bytes:
    """Return a text with some of its words replaced by others."""
    words = whole.split(b" ")
    for _ in range(draw.choice((1, 1, 2, 10))):
        words[draw.randrange(len(words))] = draw.choice(_WORDS)
    return b" ".join(words)


def _places(value: Any) -> list[tuple[Any, Any]]:
    found, waiting = [], [value]
    while waiting:
        each = waiting.pop()
        inner = (
            list(each.items())
            if isinstance(each, dict)
            else list(enumerate(each))
            if isinstance(each, list)
            else []
        )
        # Of long lists a few: else every mutation hits a number among thousands.
        for key, part in inner[:6] + inner[-2:] if len(inner) > 20 else inner:
            found.append((each, key))
            waiting.append(part)
    return found


def _holds(parent: Any, key: Any) -> bool:
    return key in parent if isinstance(parent, dict) else key < len(parent)


def _nested(depth: int) -> Any:
    value: Any = 1
    for level in range(depth):
        value = [value] if level % 2 else {"a": value}
    return value
