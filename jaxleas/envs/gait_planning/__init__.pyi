from .config import GaitPlanningConfig as GaitPlanningConfig
from .config import GaitWorldsConfig as GaitWorldsConfig
from .phases import Phases as Phases
from .phases import PlanningState as PlanningState
from .quadruped import QuadrupedConfig as QuadrupedConfig
from .task import GaitPlanning as GaitPlanning
