"""Entries in the JSON of a contact plan, each refused by one sentence."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from jaxleas.contacts.posture import Posture, posture_from_json
from jaxleas.types import InputError


def number(path: str | Path, content: dict[str, Any], key: str) -> float | None:
    """Return a number; None where the key is missing or null."""
    value = content.get(key)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{path}: {key} must be a number, or null, not {value!r:.60}")
    return float(value)


def word(path: str | Path, content: dict[str, Any], key: str, known: Mapping[Any, str]) -> Any:
    """Return one of the known words, or None."""
    value = content.get(key)
    if value is not None and value not in list(known):
        raise InputError(f"{path}: {key} must be one of {', '.join(known)}, or null")
    return value


def count(path: str | Path, content: dict[str, Any], key: str) -> int | None:
    """Return a whole number; None where the key is missing or null."""
    value = content.get(key)
    if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise InputError(f"{path}: {key} must be a whole number, or null, not {value!r:.60}")
    return value


def postures_of(path: str | Path, content: Any) -> tuple[Posture, ...]:
    """Return the postures of a sampling plan."""
    if not isinstance(content, list):
        raise InputError(f"{path}: postures must be a list, or null")
    where = f"{path}: posture"
    return tuple(posture_from_json(f"{where} {n}", each) for n, each in enumerate(content))


def robustness_of(path: str | Path, content: Any) -> tuple[float, ...] | None:
    """Return the robustness of each posture [N], or None."""
    if content is None:
        return None
    if not isinstance(content, list):
        raise InputError(f"{path}: robustness must be a list of numbers [N], or null")
    return tuple(numbers(path, "robustness", content, (len(content),)).tolist())


def numbers(path: str | Path, key: str, value: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return an array of finite numbers of a shape."""
    try:
        array = np.array(value, dtype=np.float64).reshape((0, *shape[1:]) if value == [] else -1)
        array = array.reshape(shape)
    except (TypeError, ValueError) as error:
        wanted = " x ".join(str(size) for size in shape)
        raise InputError(f"{path}: {key} must hold {wanted} numbers, one row per step") from error
    if not np.isfinite(array).all():
        raise InputError(f"{path}: {key} holds a number that is not finite")
    return array
