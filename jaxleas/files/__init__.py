"""Plain files: written whole or not at all, read with errors that name the file and the key."""

from jaxleas.files.atomic import atomic_path, write_bytes, write_json, write_npz, write_text
from jaxleas.files.reading import read_json, read_npz, refuse_misspelt_keys

__all__ = [
    "atomic_path",
    "read_json",
    "read_npz",
    "refuse_misspelt_keys",
    "write_bytes",
    "write_json",
    "write_npz",
    "write_text",
]
