"""The viewer: a page in the browser that drives policies and plays back paths and plans."""
