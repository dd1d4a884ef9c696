"""Figures of motion models from the scores of a fit: the worst of both pairs and all feet."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from benchmarks.contacts.rows import Row
from jaxleas.files import read_json

R2, YAW_R2, FOOT_R2 = 99.5, 99.5, 99.3  # this project's own targets [%]
COM, YAW, FOOT, RELATIVE = 2.0, 5.0, 8.0, 2.5  # [mm], of the yaw [mrad]
C4_OVER_C1 = 0.6


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

    for name, limit in (("x", R2), ("y", R2), ("yaw", YAW_R2)):
        least = min(values("r2", lambda each, name=name: each["target"] == f"com {name}"))
        yield Row(f"com_{name}_r2", "%", [least], limit=limit, better="higher")
    for axis in ("x", "y"):
        least = min(values("r2", lambda each, axis=axis: _is_foot(each, "absolute", axis)))
        yield Row(f"foot_{axis}_r2", "%", [least], limit=FOOT_R2, better="higher")
    for name, unit, limit in (("x", "mm", COM), ("y", "mm", COM), ("yaw", "mrad", YAW)):
        most = max(values("error", lambda each, name=name: each["target"] == f"com {name}"))
        yield Row(f"com_{name}_error", unit, [most], limit=limit)
    for axis in ("x", "y"):
        most = max(values("error", lambda each, axis=axis: _is_foot(each, "absolute", axis)))
        yield Row(f"foot_{axis}_error", "mm", [most], limit=FOOT)
    most = max(values("error", lambda each: each["feet"] == "relative"))
    yield Row("foot_relative_error", "mm", [most], limit=RELATIVE)
    both = [values("error", lambda each: each["target"] == "com x", each) for each in ("C4", "C1")]
    ratio = max(c4 / c1 for c4, c1 in zip(*both, strict=True))
    yield Row("c4_over_c1_error", "of C1's", [ratio], limit=C4_OVER_C1)


def _is_foot(score: dict[str, Any], feet: str, axis: str) -> bool:
    return score["feet"] == feet and score["target"].endswith(f" {axis}")
