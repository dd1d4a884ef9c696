"""Terrains as files of others: `catalogue` lists them; each file here writes one kind."""
