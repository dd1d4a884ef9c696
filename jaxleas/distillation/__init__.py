"""Distillation: a policy and a surrogate, refined in turn against an exact contact planner."""
