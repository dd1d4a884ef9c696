"""The thesis's printed numbers, from one data file next to this module: `thesis.json`."""

import json
from functools import cache
from importlib import resources
from typing import Literal

from jaxleas.configuration import Strict
from jaxleas.evaluation import CellResult


class PublishedRow(Strict):
    """One cell of a table; None: not printed, or the method cannot start in this way."""

    cell: str
    yaw: float
    speed: float
    values: tuple[float | None, ...]


class PublishedTable(Strict):
    """One quantity of one table, by cell and method."""

    table: str
    title: str
    planner: str | None
    quantity: Literal["reached", "planned", "robustness"]
    starts: str
    methods: tuple[str, ...]
    rows: tuple[PublishedRow, ...]


class Published(Strict):
    """Tables, and values read off figures in words: no number of a curve is guessed."""

    version: Literal[1]
    source: str
    tables: tuple[PublishedTable, ...]
    figures: dict[str, str]
    learning: dict[str, str]
    """Figure that shows learning with a planner, by the planner's name."""

    def learning_of(self, planner: str) -> str:
        """Return the words read off the figure of learning with a planner; empty without one."""
        return self.figures.get(self.learning.get(planner, ""), "")


@cache
def thesis() -> Published:
    """Return the thesis's numbers."""
    text = resources.files("jaxleas.reports").joinpath("thesis.json").read_text("utf-8")
    return Published.model_validate(json.loads(text))


def published_value(
    quantity: str, planner: str | None, cell: str, yaw: float, speed: float, method: str
) -> float | None:
    """Return one printed number, or None."""
    for table in thesis().tables:
        if (table.quantity, table.planner) != (quantity, planner) or method not in table.methods:
            continue
        for row in table.rows:
            if (row.cell, row.yaw, row.speed) == (cell, yaw, speed):
                return row.values[table.methods.index(method)]
    return None


def printed_planners() -> tuple[str, ...]:
    """Return the names of the planners with which the thesis prints tables."""
    return tuple(dict.fromkeys(each.planner for each in thesis().tables if each.planner))


def published(result: CellResult) -> float | None:
    """Return the thesis's success with a planner that it prints (tables 4.1-4.3), if any."""
    key = result.name, result.yaw, result.speed, result.method
    found = (published_value("planned", planner, *key) for planner in printed_planners())
    return next((value for value in found if value is not None), None)
