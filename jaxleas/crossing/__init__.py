"""A quadruped that crosses terrain in physics: planned at each contact, logged, counted."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
