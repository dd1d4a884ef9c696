"""Evaluation: named suites, judges, and results with intervals."""

from jaxleas.evaluation.comparison import Planning, compare
from jaxleas.evaluation.contenders import Contenders, make_contenders
from jaxleas.evaluation.exact import ask, judge_exact, summarise_plans, walker
from jaxleas.evaluation.judge import judge
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
    "Contenders",
    "Evaluation",
    "Planning",
    "Suite",
    "ask",
    "compare",
    "judge",
    "judge_exact",
    "make_contenders",
    "make_suite",
    "read_evaluation",
    "summarise_plans",
    "walker",
    "wilson_interval",
    "write_evaluation",
]
