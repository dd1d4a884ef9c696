from .comparison import Comparison as Comparison
from .comparison import compare_runs as compare_runs
from .finding import find_runs as find_runs
from .record import RunRecord as RunRecord
from .record import State as State
from .record import read_record as read_record
