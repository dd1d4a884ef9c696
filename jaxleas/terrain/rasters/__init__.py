"""Files of heights in rows and columns: images, tables, grids and maps of bags."""
