"""Tables 5.1 to 5.7 of the thesis: its numbers, and where ours are among the scores."""

from collections.abc import Iterable
from dataclasses import dataclass

from jaxleas.footsteps.features import Predictors
from jaxleas.footsteps.judging import ALL
from jaxleas.footsteps.scores import Score

Numbers = tuple[float, float]
"""R2 [%] and mean absolute error [mm]; of a yaw [mrad], which the thesis calls mm."""


@dataclass(frozen=True)
class Column:
    """One of the two models that a table compares.

    Attributes:
        title: what the model sees or predicts.
        predictors: choice of predictors.
        feet: how a foot is predicted.
        printed: numbers of the thesis, one for each row.
    """

    title: str
    predictors: Predictors
    feet: str
    printed: tuple[Numbers, ...]


@dataclass(frozen=True)
class Table:
    """One table of the thesis.

    Attributes:
        number: its number.
        rows: components that are predicted.
        is_foot: whether they are those of the front left foot, not of the centre of mass.
        columns: the two models compared.
    """

    number: str
    rows: tuple[str, ...]
    is_foot: bool
    columns: tuple[Column, Column]


_C1 = Column("C1, partial feet", "C1", "", ((97.0, 3.81), (95.0, 4.76), (94.0, 2.80)))
_C2 = Column("C2, all feet", "C2", "", ((97.1, 3.78), (96.3, 3.78), (94.2, 2.88)))
_C3 = Column("C3, previous command", "C3", "", ((97.2, 3.70), (96.4, 3.69), (96.3, 2.03)))
_C4 = Column("C4, velocity", "C4", "", ((98.1, 3.62), (97.9, 3.53), (96.9, 1.86)))
_F1 = Column("C1, swinging feet", "C1", "absolute", ((98.7, 5.76), (98.7, 4.39)))
_F2 = Column("C2, all feet", "C2", "absolute", ((99.2, 4.49), (98.8, 3.91)))
_F3 = Column("C3, previous command", "C3", "absolute", ((99.4, 3.33), (99.0, 3.15)))
_F4 = Column("C4, velocity", "C4", "absolute", ((99.5, 3.29), (99.4, 2.86)))
_RELATIVE = Column("relative", "C4", "relative", ((97.5, 3.77), (95.9, 3.04)))
_ABSOLUTE = Column("absolute", "C4", "absolute", _F4.printed)
_COM_ROWS, _FOOT_ROWS = ("x", "y", "yaw"), ("x", "y")
TABLES = (
    Table("5.1", _COM_ROWS, False, (_C1, _C2)),
    Table("5.2", _COM_ROWS, False, (_C2, _C3)),
    Table("5.3", _COM_ROWS, False, (_C3, _C4)),
    Table("5.4", _FOOT_ROWS, True, (_F1, _F2)),
    Table("5.5", _FOOT_ROWS, True, (_F2, _F3)),
    Table("5.6", _FOOT_ROWS, True, (_F3, _F4)),
    Table("5.7", _FOOT_ROWS, True, (_RELATIVE, _ABSOLUTE)),
)


def score_for(
    scores: Iterable[Score], table: Table, column: Column, row: str, pair: str
) -> Score | None:
    """Return our score for one entry of a table: linear, by run, all movements.

    Args:
        scores: scores of a fit.
        table: table of the thesis.
        column: one of its columns.
        row: one of its rows.
        pair: names of the feet of the pair; the foot is the first of them.
    """
    target = f"{pair.split('/')[0]} {row}" if table.is_foot else f"com {row}"
    wanted = (target, pair, "linear", column.predictors, column.feet, "run", ALL)
    for each in scores:
        found = (each.target, each.pair, each.model, each.predictors, each.feet, each.split)
        if (*found, each.movement) == wanted:
            return each
    return None
