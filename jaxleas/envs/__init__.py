"""Environments: what a task is, and the tasks, each with its state, reward and step."""
