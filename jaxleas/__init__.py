"""Steering policies that know what their contact planner can do."""
