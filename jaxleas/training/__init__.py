"""Training: networks, PPO over Brax, run folders, checkpoints and resume."""
