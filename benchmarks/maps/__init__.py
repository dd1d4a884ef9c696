"""Contacts planned on noisy height maps, judged on the terrain that the maps are of."""
