"""Plain files: written whole or not at all; errors in reading name the file and the key."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
