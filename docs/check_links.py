"""Follow every link of the built site that stays inside it, and list those that leave it, which nobody fetches.

python docs/check_links.py docs/_build/html
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Links of a page, what it loads, and the names that links may point at."""

    def __init__(self, text: str) -> None:
        """Read a page."""
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.names: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take the attributes that name or point."""
        found = dict(attrs)
        self.names |= {name for name in (found.get("id"), found.get("name")) if name}
        if tag == "a" and found.get("href"):
            self.links.append(str(found["href"]))
        target = found.get("href") if tag == "link" else found.get("src")
        if target and "canonical" not in str(found.get("rel")):
            self.loaded.append(target)


def main(root: Path) -> int:
    """Print broken links and those that leave the site; return 1 if one is broken or a page loads something from elsewhere."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(root.rglob("*.html"))}
    broken, outside = [], set()
    for path, page in pages.items():
        for link in page.loaded:
            if urlsplit(link).scheme in ("http", "https") or link.startswith("//"):
                broken.append(f"{path.relative_to(root)}: loads {link}")
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme:
                outside.add(link)
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path.resolve()
            known = pages.get(root / target.relative_to(root.resolve())) if target.is_relative_to(root.resolve()) else None
            named = not parts.fragment or known is None or unquote(parts.fragment) in known.names
            if target.parent.name == "viewer":  # behind the # stands an instant [s]
                named = re.fullmatch(r"[\d.e-]*", parts.fragment) is not None
            if not target.exists() or not named:
                broken.append(f"{path.relative_to(root)}: {link}")
    print(f"{len(pages)} pages; {len(outside)} links leave the site:", *sorted(outside), sep="\n  ")
    print(f"{len(broken)} broken", *broken, sep="\n  ")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
