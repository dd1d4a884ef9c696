"""Meshes: files of triangles, the bodies that these make, and scenes and maps made of them."""
