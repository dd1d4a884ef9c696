"""Configurations in which the probes learn in seconds."""

from pathlib import Path

DRIFT, MAZE = "tests.probes.drift:Drift", "tests.probes.maze:Maze"
TEXT = {
    DRIFT: """
env: {task: "tests.probes.drift:Drift"}
terrain: {arenas: 4}
network: {hidden: [32, 32]}
ppo: {steps: 81920, environments: 256, unroll: 16, minibatches: 4, epochs: 2, candidates: 256,
  learning_rate: 3.0e-3}
held_out: {every: 5, starts: 128, arenas: 2, steps: 20}
""",
    MAZE: """
env: {task: "tests.probes.maze:Maze"}
terrain: {arenas: 1}
network: {kind: maps, hidden: [32], maps: {channels: [8], kernels: [3], latent: 16}}
ppo: {steps: 81920, environments: 128, unroll: 16, minibatches: 4, epochs: 4, candidates: 128,
  learning_rate: 2.0e-3, discount: 0.95}
held_out: {every: 10, starts: 128, arenas: 1, steps: 15}
""",
}


def write(folder: Path, task: str) -> Path:
    """Write a probe's configuration."""
    path = folder / f"{task.rpartition(':')[2].lower()}.yaml"
    path.write_text(TEXT[task])
    return path
