"""A quadruped over stairs and gaps, planned and blind."""
