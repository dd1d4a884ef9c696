"""A real training, killed at random moments: does it go on as if nothing had happened?"""
