"""Figures of motion models from the scores of fits: the worst of both pairs and all feet."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.contacts.rows import Row
from benchmarks.measurements import Better
from jaxleas.files import read_json

Suits = Callable[[dict[str, Any]], bool]
C4_OVER_C1, C4_OVER_TABLE = 0.6, 0.5  # this project's own targets, with all variations
COM_R2, COM_ERROR, YAW_ERROR = 99.5, 2.0, 5.0  # those without variations [%], [mm], [mrad]
FOOT_R2, FOOT_ERROR, RELATIVE_ERROR = 99.3, 8.0, 2.5


@dataclass(frozen=True)
class _Figure:
    """One figure of C4 by run.

    Attributes:
        name: name of its row.
        key: "r2" or "error".
        unit: unit.
        limit: this project's own target without variations.
        suits: whether a score is of it.
    """

    name: str
    key: str
    unit: str
    limit: float
    suits: Suits

    def row(self, fits: Sequence[list[dict[str, Any]]], is_varied: bool) -> Row:
        """Return the worst of all pairs and feet, one value for each fit."""
        better: Better = "higher" if self.key == "r2" else "lower"
        worst = min if better == "higher" else max
        values = [worst(each[self.key] for each in fit if self.suits(each)) for fit in fits]
        name = f"{self.name}_varied" if is_varied else self.name
        limit = None if is_varied else self.limit
        return Row(name, self.unit, values, limit=limit, better=better)


def _com(axis: str) -> Suits:
    return lambda score: score["target"] == f"com {axis}"


def _foot(axis: str) -> Suits:
    return lambda score: score["feet"] == "absolute" and score["target"].endswith(f" {axis}")


FIGURES = (
    *(_Figure(f"com_{axis}_r2", "r2", "%", COM_R2, _com(axis)) for axis in ("x", "y", "yaw")),
    *(_Figure(f"foot_{axis}_r2", "r2", "%", FOOT_R2, _foot(axis)) for axis in ("x", "y")),
    *(_Figure(f"com_{axis}_error", "error", "mm", COM_ERROR, _com(axis)) for axis in ("x", "y")),
    _Figure("com_yaw_error", "error", "mrad", YAW_ERROR, _com("yaw")),
    *(_Figure(f"foot_{axis}_error", "error", "mm", FOOT_ERROR, _foot(axis)) for axis in ("x", "y")),
    _Figure(
        "foot_relative_error",
        *("error", "mm", RELATIVE_ERROR),
        lambda score: score["feet"] == "relative",
    ),
)


def model_rows(plain: Path, varied: Sequence[Path]) -> Iterator[Row]:
    """Yield R2 and mean absolute errors by run of C4, and its error over those of its rivals.

    Args:
        plain: scores.json of a fit to footsteps without noise and of one friction and mass.
        varied: scores.json of fits to footsteps with all variations, one for each collection; their
            rows end in _varied, and have one value for each.
    """
    for paths, is_varied in (([plain], False), (varied, True)):
        fits = [_by_run(path, "linear", "C4") for path in paths]
        for figure in FIGURES:
            yield figure.row(fits, is_varied)
    ratios = [_over(path, "linear") for path in varied]
    yield Row("c4_over_c1_error", "of C1's", ratios, limit=C4_OVER_C1)
    ratios = [_over(path, "table") for path in varied]
    yield Row("c4_over_table_error", "of the table of means'", ratios, limit=C4_OVER_TABLE)


def _by_run(path: Path, model: str, predictors: str) -> list[dict[str, Any]]:
    """Return the scores of one model on runs that it has not seen, all movements together."""
    wanted = {"model": model, "predictors": predictors, "split": "run", "movement": "all"}
    return [each for each in read_json(path)["scores"] if wanted.items() <= each.items()]


def _over(path: Path, rival: str) -> float:
    """Return C4's mean error of the x of the centre of mass over a rival's, which sees C1: the
    worse pair's."""
    mine, others = (
        {each["pair"]: each["error"] for each in _by_run(path, *which) if _com("x")(each)}
        for which in (("linear", "C4"), (rival, "C1"))
    )
    return max(mine[pair] / others[pair] for pair in mine)
