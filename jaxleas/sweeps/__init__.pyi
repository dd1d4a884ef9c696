from .border import open_sweep as open_sweep
from .population_config import open_population as open_population
from .population_loop import train_population as train_population
from .results import TrialResult as TrialResult
from .results import best_of as best_of
from .study import read_results as read_results
from .sweep import run_sweep as run_sweep
