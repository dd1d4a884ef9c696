"""Figures of motion models from the scores of a fit: the worst of both pairs and all feet."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from benchmarks.contacts.rows import Row
from jaxleas.files import read_json

C4_OVER_C1 = 0.6  # this project's own target; those of the others are for data without variations


def model_rows(scores: Path) -> Iterator[Row]:
    """Yield R2 and mean absolute errors by run of C4, and C4's error over C1's for the x of the
    centre of mass.

    Args:
        scores: scores.json of `jaxleas gait fit`.
    """
    found = [
        each
        for each in read_json(scores)["scores"]
        if (each["model"], each["split"], each["movement"]) == ("linear", "run", "all")
    ]

    def values(
        key: str, suits: Callable[[dict[str, Any]], bool], choice: str = "C4"
    ) -> list[float]:
        return [each[key] for each in found if each["predictors"] == choice and suits(each)]

    for name in ("x", "y", "yaw"):
        least = min(values("r2", lambda each, name=name: each["target"] == f"com {name}"))
        yield Row(f"com_{name}_r2", "%", [least], better="higher")
    for axis in ("x", "y"):
        least = min(values("r2", lambda each, axis=axis: _is_foot(each, "absolute", axis)))
        yield Row(f"foot_{axis}_r2", "%", [least], better="higher")
    for name, unit in (("x", "mm"), ("y", "mm"), ("yaw", "mrad")):
        most = max(values("error", lambda each, name=name: each["target"] == f"com {name}"))
        yield Row(f"com_{name}_error", unit, [most])
    for axis in ("x", "y"):
        most = max(values("error", lambda each, axis=axis: _is_foot(each, "absolute", axis)))
        yield Row(f"foot_{axis}_error", "mm", [most])
    most = max(values("error", lambda each: each["feet"] == "relative"))
    yield Row("foot_relative_error", "mm", [most])
    both = [values("error", lambda each: each["target"] == "com x", each) for each in ("C4", "C1")]
    ratio = max(c4 / c1 for c4, c1 in zip(*both, strict=True))
    yield Row("c4_over_c1_error", "of C1's", [ratio], limit=C4_OVER_C1)


def _is_foot(score: dict[str, Any], feet: str, axis: str) -> bool:
    return score["feet"] == feet and score["target"].endswith(f" {axis}")
