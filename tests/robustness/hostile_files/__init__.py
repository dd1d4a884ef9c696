"""Files from strangers: valid ones of every kind, mutated, and what the readers make of them."""
