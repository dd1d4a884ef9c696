"""Contact problems, their exact planners (mixed-integer, SL1M, sampling) and certificates."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
