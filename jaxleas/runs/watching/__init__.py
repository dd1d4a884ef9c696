"""Watchers of a run: TensorBoard, Weights & Biases, MLflow; all receive the same rows."""

from jaxleas.runs.watching.audience import Audience
from jaxleas.runs.watching.catalogue import WATCHERS, open_watchers, require_watchers
from jaxleas.runs.watching.watcher import Status, Watcher

__all__ = ["WATCHERS", "Audience", "Status", "Watcher", "open_watchers", "require_watchers"]
