"""Environments: what a task is, and the tasks, each with its state, reward and step."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
