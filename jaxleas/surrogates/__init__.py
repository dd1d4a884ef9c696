"""A contact planner's learned stand-in: features, network, fit, calibration; as a condition."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
