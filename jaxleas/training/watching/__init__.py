"""Whoever watches a run: TensorBoard, Weights & Biases, MLflow, all told the same rows."""

from jaxleas.training.watching.audience import Audience
from jaxleas.training.watching.catalogue import WATCHERS, open_watchers, require_watchers
from jaxleas.training.watching.watcher import Status, Watcher

__all__ = ["WATCHERS", "Audience", "Status", "Watcher", "open_watchers", "require_watchers"]
