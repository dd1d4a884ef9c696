"""The viewer: a page in the browser that drives policies and plays back paths and plans."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
