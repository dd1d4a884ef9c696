"""Tasks in this process, in other processes, or on Ray; a worker's death loses no task."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
