"""Benchmarks: how fast it is here, against what others use and against the machine's limit."""
