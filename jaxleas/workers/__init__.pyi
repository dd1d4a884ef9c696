from .processes import Here as Here
from .processes import ProcessWorkers as ProcessWorkers
from .processes import WorkerError as WorkerError
from .processes import Workers as Workers
from .processes import require_count as require_count
from .processes import workers_for as workers_for
from .ray_workers import RayWorkers as RayWorkers
