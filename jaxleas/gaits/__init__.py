"""Gaits on any terrain: plans of support phases, of a search or a policy, certified."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
