"""Small sweep files for tests."""

from pathlib import Path

import yaml

from tests.training.runs import TINY


def write_sweep(folder: Path, name: str = "sweep.yaml", **changes) -> Path:
    """Write a tiny run configuration and a sweep over it; return the sweep's file."""
    (folder / "tiny.yaml").write_text(yaml.safe_dump(TINY))
    content = {
        "config": "tiny.yaml",
        "space": {"ppo.learning_rate": {"low": 1e-4, "high": 1e-2, "log": True}},
        "trials": 4,
    }
    (folder / name).write_text(yaml.safe_dump(content | changes, sort_keys=False))
    return folder / name


def write_population(folder: Path, **changes) -> Path:
    """Write a tiny run configuration and a population of it; return the population's file."""
    (folder / "tiny.yaml").write_text(yaml.safe_dump(TINY))
    path = folder / "population.yaml"
    path.write_text(
        yaml.safe_dump({"config": "tiny.yaml", "seeds": [0, 1]} | changes, sort_keys=False)
    )
    return path
