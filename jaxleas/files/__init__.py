"""Plain files: written whole or not at all; errors in reading name the file and the key."""

from jaxleas.files.atomic import (
    atomic_path,
    sweep_temporaries,
    write_bytes,
    write_json,
    write_npz,
    write_text,
)
from jaxleas.files.digest import digest_of, require_digest
from jaxleas.files.json_text import parse_json
from jaxleas.files.keys import refuse_misspelt_keys
from jaxleas.files.lock import FolderLock, InUseError
from jaxleas.files.lock_holder import is_held
from jaxleas.files.reading import (
    is_file,
    read_array,
    read_bytes,
    read_json,
    read_npz,
    require_file,
    require_version,
    require_version_array,
)
from jaxleas.files.typed import read_typed, typed

__all__ = [
    "FolderLock",
    "InUseError",
    "atomic_path",
    "digest_of",
    "is_file",
    "is_held",
    "parse_json",
    "read_array",
    "read_bytes",
    "read_json",
    "read_npz",
    "read_typed",
    "refuse_misspelt_keys",
    "require_digest",
    "require_file",
    "require_version",
    "require_version_array",
    "sweep_temporaries",
    "typed",
    "write_bytes",
    "write_json",
    "write_npz",
    "write_text",
]
