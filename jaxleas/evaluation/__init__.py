"""Evaluation: named suites, success tables with intervals, pictures, the run report."""

from jaxleas.evaluation.judge import judge
from jaxleas.evaluation.report import write_report
from jaxleas.evaluation.result_file import (
    CellResult,
    Evaluation,
    read_evaluation,
    write_evaluation,
)
from jaxleas.evaluation.statistics import wilson_interval
from jaxleas.evaluation.suites import SUITES, Cell, Suite, make_suite

__all__ = [
    "SUITES",
    "Cell",
    "CellResult",
    "Evaluation",
    "Suite",
    "judge",
    "make_suite",
    "read_evaluation",
    "wilson_interval",
    "write_evaluation",
    "write_report",
]
