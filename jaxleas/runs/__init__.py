"""Run folders, checkpoints, metrics, watchers, progress, provenance."""
