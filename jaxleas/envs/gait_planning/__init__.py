"""Gait planning: support phases of a quadruped, each transition decided by CROC (D sec. III-A)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
