"""Contact transitions drawn at random, and those of the reference with their verdicts."""
