"""A walking controller's footsteps: records, motion models, foot cost map, velocity A*."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
