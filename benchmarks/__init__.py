"""Benchmarks: the speed here, compared with other software and with the machine's limit."""
