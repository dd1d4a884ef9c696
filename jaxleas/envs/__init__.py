"""Environments: each room has its state, observation, reward, termination and step."""
