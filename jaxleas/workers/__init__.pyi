from .processes import ProcessWorkers as ProcessWorkers
from .processes import WorkerError as WorkerError
from .processes import workers_for as workers_for
from .ray_workers import RayWorkers as RayWorkers
from .workers import Here as Here
from .workers import Workers as Workers
from .workers import require_count as require_count
