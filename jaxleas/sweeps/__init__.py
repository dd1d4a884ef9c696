"""Sweeps over configurations, and populations of policies trained in one compiled program.

Names are imported on first use: a sweep starts many workers, and each needs only some names.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
