"""Plain files: written whole or not at all, read with errors that name the file and the key."""

from jaxleas.files.atomic import (
    atomic_path,
    sweep_temporaries,
    write_bytes,
    write_json,
    write_npz,
    write_text,
)
from jaxleas.files.json_text import parse_json
from jaxleas.files.keys import refuse_misspelt_keys
from jaxleas.files.lock import FolderLock
from jaxleas.files.reading import (
    read_bytes,
    read_json,
    read_npz,
    require_version,
    require_version_array,
)

__all__ = [
    "FolderLock",
    "atomic_path",
    "parse_json",
    "read_bytes",
    "read_json",
    "read_npz",
    "refuse_misspelt_keys",
    "require_version",
    "require_version_array",
    "sweep_temporaries",
    "write_bytes",
    "write_json",
    "write_npz",
    "write_text",
]
