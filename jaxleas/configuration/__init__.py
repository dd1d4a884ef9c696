"""YAML and command line to typed, validated values."""
