"""Contact problems and their exact planners."""
