"""Typed, validated values from YAML files and the command line."""
