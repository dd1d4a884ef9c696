"""Refuse a built site that fetches from another host: python scripts/check_site.py SITE."""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

FETCHED = {"src", "srcset", "poster", "data"}
LINKS = {"stylesheet", "icon", "preload", "prefetch", "preconnect", "dns-prefetch", "manifest"}
OUTSIDE = re.compile(r"^\s*(?:https?:)?//")
IN_STYLES = re.compile(r"(?:url\(\s*|@import\s+)['\"]?((?:https?:)?//[^'\")\s]+)")


class _Fetches(HTMLParser):
    """Collects what a browser fetches of itself when it opens a page; links to click are free."""

    def __init__(self) -> None:
        super().__init__()
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        wanted = [given[name] for name in FETCHED & given.keys()]
        if tag == "link" and LINKS & set(given.get("rel", "").split()):
            wanted.append(given.get("href", ""))
        if "mermaid" in given.get("class", "").split():
            wanted.append("https://unpkg.com/mermaid")  # the theme's script would fetch it
        wanted += IN_STYLES.findall(given.get("style", ""))
        self.outside += [each for each in wanted if OUTSIDE.match(each)]


def outside_fetches(site: Path) -> list[str]:
    """Return `file: address` of whatever the pages and styles of a site fetch elsewhere."""
    found = []
    for path in sorted(site.rglob("*")):
        if path.suffix == ".html":
            parser = _Fetches()
            text = path.read_text(encoding="utf-8")
            parser.feed(text)
            styles = re.findall(r"<style[^>]*>(.*?)</style>", text, re.DOTALL)
            addresses = parser.outside + IN_STYLES.findall("".join(styles))
        elif path.suffix == ".css":
            addresses = IN_STYLES.findall(path.read_text(encoding="utf-8"))
        else:
            continue
        found += [f"{path.relative_to(site)}: {each}" for each in addresses]
    return found


if __name__ == "__main__":
    outside = outside_fetches(Path(sys.argv[1]))
    if outside:
        sys.exit("the site fetches from other hosts:\n" + "\n".join(outside))
    print(f"{sys.argv[1]}/index.html: nothing is fetched from another host")
