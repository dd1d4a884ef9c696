"""What is written for the compiler and not for people: each with a plain twin."""
