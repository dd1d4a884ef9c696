"""Guide paths: steering methods, and the roll-outs in which they walk."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
