"""The rivals: other software on the same task.

Nothing here imports jaxleas or JAX: the task comes as a file, and the programs run in any Python
with the rival installed.
"""
