"""The documentation site: it builds strictly, fetches nothing, and every page has its place."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from scripts.check_site import outside_fetches

ROOT = Path(__file__).resolve().parents[1]


def test_every_page_has_a_place() -> None:
    """A page that nobody placed: give it a line in mkdocs.yml under `nav`."""
    nav = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    assert [page.name for page in (ROOT / "docs").glob("*.md") if f": {page.name}" not in nav] == []


@pytest.mark.parametrize(
    "page",
    [
        '<script src="https://cdn.example/x.js"></script>',
        '<link rel="stylesheet" href="//fonts.example/a.css">',
        '<link rel="preconnect" href="https://fonts.example">',
        '<img src="http://pictures.example/a.png">',
        '<p style="background: url(https://pictures.example/a.png)">',
        "<style>@import 'https://fonts.example/a.css';</style>",
        '<pre class="mermaid">',
    ],
)
def test_what_is_fetched_is_found(tmp_path: Path, page: str) -> None:
    (tmp_path / "a.html").write_text(page)
    assert len(outside_fetches(tmp_path)) == 1


def test_what_is_local_or_only_clicked_passes(tmp_path: Path) -> None:
    page = '<a href="https://example.org">x</a><img src="a.png"><script src="b.js"></script>'
    (tmp_path / "a.html").write_text(page)
    (tmp_path / "a.css").write_text("p { background: url(a.png) }")
    assert outside_fetches(tmp_path) == []
    (tmp_path / "b.css").write_text("@font-face { src: url(https://fonts.example/a.woff2) }")
    assert len(outside_fetches(tmp_path)) == 1


@pytest.mark.slow
def test_the_site_is_built_strictly_and_fetches_nothing(tmp_path: Path) -> None:
    pytest.importorskip("mkdocs")
    pytest.importorskip("material")
    pytest.importorskip("mkdocstrings")
    built = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--quiet", "--site-dir", str(tmp_path / "site")],
        cwd=ROOT,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    assert outside_fetches(tmp_path / "site") == []
    reference = (tmp_path / "site/reference/labels.html").read_text(encoding="utf-8")
    assert 'id="jaxleas.labels.OwnPlanner"' in reference
    assert (tmp_path / "site/changelog.html").is_file()
