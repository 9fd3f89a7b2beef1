"""`wirerope board`: the drawing board, a page of this machine."""

from contextlib import nullcontext
from pathlib import Path
from typing import Literal


def board(
    what: Path | None = None, *, template: Literal["genset"] | None = None, port: int = 0, browser: bool = True
) -> int:  # fmt: skip
    """Place equipment and mounts with the mouse in a page of this machine, and watch the verdict.

    WHAT is a folder of the tables that `wirerope new` takes, or a job whose model is such a folder. What is saved are these
    files and nothing else: `wirerope cases` gives the same figures. `wirerope new FOLDER --blank` makes tables to begin with.
    A model, a scenario or a run is shown as it stands, behind sliders. The page is served on this machine alone, and nothing
    is sent anywhere. Ctrl-C ends it.

    wirerope board genset --template genset

    Args:
        what: folder of tables, file of a job, model, scenario or run; the current folder by default.
        template: copy the tables of a template into the folder first.
        port: on which the page is served; a free one by default.
        browser: open the page; its address is printed in any case.
    """
    from wirerope_mj.foundation.atomic_files import worked_on_alone
    from wirerope_mj.runs.board.board import Board
    from wirerope_mj.runs.board.opened import from_template, opened
    from wirerope_mj.views.board.server import serve

    if not 0 <= port < 65536:
        raise ValueError(f"`--port` must be from 0 to 65535, got {port}.")
    folder = what or Path()
    if template is not None:
        folder = from_template(template, what or Path(template))
    shown = opened(folder)
    job = shown.documents.files.get("job")
    with nullcontext() if job is None else worked_on_alone(job.parent, kind="board's folder"):
        serve(Board(shown), browser=browser, port=port)
    return 0
