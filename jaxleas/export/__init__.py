"""Export: a policy as ONNX and StableHLO files, checked against JAX before they are written."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
