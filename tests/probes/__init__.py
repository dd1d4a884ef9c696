"""Tiny tasks whose answers are known: the proof that the house is not built for one task."""
