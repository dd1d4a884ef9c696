"""Planar surfaces found in a height map: from a sensor's map to polygons that feet can touch."""
