"""The exact contact planners: verdicts, times, and the figures of the thesis."""
