"""Sweeps over configurations, and populations of policies trained in one compiled program."""
