"""Viewer: a page in the browser where a policy is driven and paths and plans are played back."""
