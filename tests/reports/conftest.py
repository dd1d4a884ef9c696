"""The fixtures of the evaluation, whose results are shown."""

from tests.evaluation.conftest import env, flat_suite, run

__all__ = ["env", "flat_suite", "run"]
