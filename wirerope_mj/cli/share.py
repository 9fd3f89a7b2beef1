"""`wirerope share`: a run as a folder to hand on."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def share(folder: Path, out: Path, *, force: Annotated[bool, Parameter(negative=())] = False) -> int:
    """Write report, recording and viewer of a run as one folder that any web server shows.

    Instants of events and verdicts in the report open the timeline where they are. Nothing needs the network at view time.

    Args:
        folder: folder of a run.
        out: folder to write.
        force: replace a shared folder that is there.
    """
    from wirerope_mj.foundation.plain_text import plain
    from wirerope_mj.runs.share import share_run

    files = share_run(folder, out, force=force)
    size = sum(path.stat().st_size for path in files) / 1e6
    print(plain(f"written: {out}, {len(files)} files, {size:.0f} MB, of which the viewer takes most"))
    print(plain(f"python -m http.server --directory {out} shows it at http://localhost:8000"))
    return 0
