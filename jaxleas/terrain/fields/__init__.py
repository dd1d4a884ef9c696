"""Fields: height maps of rows of sections that a quadruped's feet cross (D sec. IV-A).

A field is drawn cell by cell, not as polygons: thousands of stones would be slow to rasterise, and
what places feet on it reads heights alone.
"""
