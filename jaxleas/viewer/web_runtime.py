"""onnxruntime for browsers: two files of one npm package, kept in the user's cache folder."""

import base64
import hashlib
import os
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path

from jaxleas.files import write_bytes
from jaxleas.types import InputError

PACKAGE, VERSION = "onnxruntime-web", "1.30.0"
INTEGRITY = (
    "q0y+JrrtukXSzsBWEMccVfqX25LRmosXHF+CaRJmg8pZClzcV7svNc4rKY3jL02Vb7QmRMDs1SigqR4CXAfKYQ=="
)
"""SHA-512 of the package, in npm's notation."""
RUNTIME_FILES = ("ort.wasm.bundle.min.mjs", "ort-wasm-simd-threaded.wasm")
SECONDS = 300  # time limit of a download


def runtime_folder(given: Path | None = None) -> Path:
    """Return a folder with onnxruntime for browsers, fetched with npm if it is not cached.

    Args:
        given: the `dist` folder of the npm package, to use instead.

    Raises:
        InputError: the folder lacks a file, or npm is missing or fails.
    """
    if given is not None:
        missing = [name for name in RUNTIME_FILES if not (given / name).is_file()]
        if missing:
            raise InputError(
                f"--runtime {given} lacks {missing[0]}: give the folder dist of {PACKAGE} {VERSION}"
            )
        return given
    cache = kept_runtime()
    if not all((cache / name).is_file() for name in RUNTIME_FILES):
        _fetch(cache)
    return cache


def kept_runtime() -> Path:
    """Return the folder in which a fetched runtime is kept."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return base / "jaxleas" / f"{PACKAGE}-{VERSION}"


def _fetch(cache: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        raise InputError(
            f"the page needs {PACKAGE} {VERSION}, which npm would fetch, but there is no npm here:"
            " install Node.js, or give --runtime the folder dist of that package"
        )
    print(f"fetching {PACKAGE} {VERSION} with npm, 33 MB, once ...", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            subprocess.run(
                [npm, "pack", "--silent", f"{PACKAGE}@{VERSION}"],
                cwd=folder,
                check=True,
                capture_output=True,
                text=True,
                timeout=SECONDS,
            )
        except subprocess.TimeoutExpired as error:
            raise InputError(f"npm could not fetch {PACKAGE} within {SECONDS} s") from error
        except subprocess.CalledProcessError as error:
            reason = error.stderr.strip().splitlines()
            raise InputError(
                f"npm could not fetch {PACKAGE} {VERSION}: {reason[-1] if reason else 'no reason'}"
            ) from error
        _unpack(next(folder.glob("*.tgz")), cache)


def _unpack(package: Path, cache: Path) -> None:
    digest = hashlib.sha512(package.read_bytes()).digest()
    if base64.b64encode(digest).decode() != INTEGRITY:
        raise InputError(f"{package.name} is not the {PACKAGE} {VERSION} that was published")
    with tarfile.open(package) as archive:
        for name in RUNTIME_FILES:
            member = archive.extractfile(f"package/dist/{name}")
            assert member is not None  # the digest above implies that the file is there
            write_bytes(cache / name, member.read())
