"""The contact problem and its exact planners."""
