"""What MkDocs needs besides mkdocs.yml: pages that are made, and links that leave docs/.

The reference has one page per room, made of its docstrings: of what its face names, or, where that
names nothing, of all its modules. The changelog is the repository's own.
"""

import ast
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "jaxleas"
README = "index.md"
LINK = re.compile(r"\[([^\]]+)\]\(((?:\.\./|examples/|benchmarks/|LICENSE)[^)]*)\)")


def rooms() -> list[str]:
    """Return the packages of jaxleas, by name."""
    return sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))


def on_config(config: Any) -> Any:
    """Put the pages of the reference into the navigation."""
    for entry in config["nav"]:
        if "Reference" in entry:
            entry["Reference"] = [{room: f"reference/{room}.md"} for room in rooms()]
    return config


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that are made."""
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("](docs/", "](")
    files.append(File.generated(config, "changelog.md", content=changes))
    for room in rooms():
        page = File.generated(config, f"reference/{room}.md", content=reference(room))
        files.append(page)
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Let links out of docs/ be what they can be here: the README is the start, files are names."""

    def replace(match: re.Match[str]) -> str:
        text, target = match.groups()
        if target.startswith("../README.md"):
            return f"[{text}]({README})"
        return text if text.startswith("`") else f"`{text}`"

    return LINK.sub(replace, markdown)


def reference(room: str) -> str:
    """Return the page of a room: its own words, then everything public."""
    tree = ast.parse((PACKAGE / room / "__init__.py").read_text(encoding="utf-8"))
    names = exported(PACKAGE / room / "__init__.pyi")
    lines = [f"# {room}", "", ast.get_docstring(tree) or "", ""]
    for name in names or modules(room):
        lines += [f"::: jaxleas.{room}.{name}", ""]
    return "\n".join(lines)


def exported(face: Path) -> list[str]:
    """Return the functions and classes that a room's face names, from A to Z."""
    if not face.is_file():
        return []
    imports = [
        node
        for node in ast.parse(face.read_text(encoding="utf-8")).body
        if isinstance(node, ast.ImportFrom)
    ]
    names = [alias.name for node in imports for alias in node.names]
    return sorted(name for name in names if not name.isupper())


def modules(room: str) -> list[str]:
    """Return the modules of a room, dotted from there."""
    paths = sorted((PACKAGE / room).rglob("*.py"))
    names = [path.relative_to(PACKAGE / room).with_suffix("").parts for path in paths]
    return [".".join(parts) for parts in names if parts[-1] != "__init__"]
