"""Records of runs: listed and compared."""

from jaxleas.records.comparison import Comparison, compare_runs
from jaxleas.records.finding import find_runs
from jaxleas.records.record import RunRecord, State, read_record

__all__ = ["Comparison", "RunRecord", "State", "compare_runs", "find_runs", "read_record"]
