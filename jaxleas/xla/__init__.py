"""Code written for the compiler, not for readers; each function has a plain twin."""
