"""Contact problems, their exact planners (MIP, SL1M, A* on sets, sampling) and certificates."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
