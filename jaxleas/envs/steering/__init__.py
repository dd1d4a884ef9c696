"""LEAS steering: a root walks towards goals over terrain that it sees only locally (T ch. 3)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
