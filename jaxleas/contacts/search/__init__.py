"""Search for contact plans: best-first search over states of any kind, and exact sets of places."""
