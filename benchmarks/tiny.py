"""The smallest complete training: seconds long, with checkpoints and examinations."""

from typing import Any

BATCH = 64 * 10


def tiny_training(updates: int = 8) -> dict[str, Any]:
    """Return the configuration of the training, as in a file."""
    return {
        "terrain": {"arenas": 2, "generator": {"rows": 3, "columns": 3}},
        "network": {"hidden": [16, 16]},
        "ppo": {
            "steps": BATCH * updates,
            "environments": 64,
            "unroll": 10,
            "minibatches": 2,
            "epochs": 2,
            "candidates": 64,
        },
        "held_out": {"every": 2, "starts": 16, "arenas": 1, "steps": 40},
        "final": {"evaluate": False},
    }
