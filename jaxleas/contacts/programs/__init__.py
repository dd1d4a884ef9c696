"""Planners that choose one surface per step by a program: mixed-integer or SL1M (T 5.2, 5.3)."""
