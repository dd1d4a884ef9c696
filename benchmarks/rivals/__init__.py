"""The rivals: what people would otherwise use, on the same task.

Nothing here imports jaxleas or JAX: the task comes as a file, and the programs run in whatever
Python has the rival installed.
"""
