"""Training: networks, PPO for any task, checkpoints and resume."""
