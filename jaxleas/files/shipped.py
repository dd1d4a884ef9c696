"""Files that come with the package: configurations, and policies trained from them.

They stand at the top of the repository, where people look for them. The wheel holds the same files
inside the package (`pyproject.toml`, sources), because a wheel has no other place.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from jaxleas.types import InputError

_PACKAGE = Path(__file__).resolve().parents[1]
_PRETRAINED = "pretrained:"
_NAME = re.compile(r"\w+")


def shipped_folder(folder: str) -> Path:
    """Return a folder of shipped files: inside the package, or of the repository around it.

    Args:
        folder: name of the folder, `configs` or `pretrained`.
    """
    inside = _PACKAGE / "shipped" / folder
    return inside if inside.is_dir() else _PACKAGE.parent / folder


def config_file(given: str | Path, folder: str | Path = "") -> Path:
    """Return the file of a configuration: a YAML file, or a shipped one by its name.

    A word without a suffix, such as `leas_p1`, is the name of a shipped configuration, unless a
    file has that name.

    Args:
        given: path of a YAML file, or name of a shipped configuration.
        folder: folder that a relative path starts from; by default the current one.

    Raises:
        InputError: there is neither such a file nor such a shipped configuration.
    """
    path = Path(folder) / given
    if not _NAME.fullmatch(str(given)) or path.is_file():
        return path
    return _find("configs", str(given), ".yaml", "configuration", "the path of a YAML file")


def policy_path(given: str | Path) -> Path:
    """Return the path of a policy, which may be a shipped one, `pretrained:NAME`.

    Args:
        given: path of a policy, or `pretrained:` and the name of a shipped one.

    Raises:
        InputError: no shipped policy has that name.
    """
    kind, found, name = str(given).partition(":")
    if not found or f"{kind}:" != _PRETRAINED:
        return Path(given)
    return _find("pretrained", name, ".npz", "pretrained policy", "the path of another")


def _find(folder: str, name: str, suffix: str, kind: str, else_give: str) -> Path:
    file = shipped_folder(folder) / f"{name}{suffix}"
    if _NAME.fullmatch(name) and file.is_file():
        return file
    raise InputError(
        f"no {kind} {name!r:.60} comes with jaxleas; give one of {', '.join(_names(folder))},"
        f" or {else_give}"
    )


def _names(folder: str) -> Sequence[str]:
    return sorted(each.stem for each in shipped_folder(folder).iterdir() if each.suffix != ".md")
