"""A folder to hand on: the report, the recording, and rerun's web viewer to show it at any instant of the report."""

import re
from pathlib import Path

from wirerope_mj.views.recording.program import viewer_files

VIEWER = "viewer"  # Folder of the viewer, beside the report
_FOLDER = Path(__file__).parent
_INSTANT = re.compile(r'(<td class="[^"]*" data-instant="([0-9.eE+-]+)">)([^<]*)(</td>)')


def linked_report(page: str) -> str:
    """Link the instants in the tables of a report's page to the viewer in the folder beside it."""
    address = f"{VIEWER}/index.html"  # not the folder's: some servers hand out files alone
    linked, count = _INSTANT.subn(rf'\1<a href="{address}#\2" target="viewer">\3</a>\4', page)
    where = "; instants in the tables open it where they are" if count else ""
    opened = f'<p><a href="{address}" target="viewer">Open the timeline</a>{where}.</p>'
    return linked.replace("</nav>", f"{opened}\n</nav>", 1)


def viewer_pages() -> dict[str, bytes]:
    """Read the files of the viewer's folder by name; they request nothing from other servers.

    WireRopeError if there is no viewer, or it does not hand out its files.
    """
    pages = {name: (_FOLDER / source).read_bytes() for name, source in (("index.html", "viewer.html"), ("show.js", "show.js"))}
    return pages | viewer_files()
