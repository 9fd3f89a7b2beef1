"""`wirerope show`: a recording in the viewer."""

from pathlib import Path

from wirerope_mj.cli.options import Flag


def show(folder: Path, *, web: Flag = False) -> int:
    """Open a run, a job, or the worst variants of a study, in the rerun viewer.

    Args:
        folder: folder of a run, of a job, or of a study whose worst variants --open-worst wrote, or a .rrd file.
        web: show it in a browser of this machine instead of a window.
    """
    from wirerope_mj.runs.folder import warn_of_alterations
    from wirerope_mj.views.recording import show as show_in_window
    from wirerope_mj.views.share.server import show_in_browser

    warn_of_alterations(folder)
    (show_in_browser if web else show_in_window)(folder)
    return 0
