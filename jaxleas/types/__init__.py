"""Values that cross rooms. This room imports no other room.

`RootMotion` is a pytree, and is imported only on access, so that code that reads and draws files
does not load JAX.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
