"""What a board writes for its page to open: the folder of a job or a run, and what is made of it."""

from dataclasses import replace
from pathlib import Path

from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.runs.board.what_if import variant
from wirerope_mj.runs.job import CASES, run_job
from wirerope_mj.runs.write import write_run

JOB, RUN = "job.rrd", "run.rrd"  # recordings
# What can be asked for, with the files that it is in the folder of a job or of a run
FILES = {
    "report": ("report.html",), "pdf": ("report.pdf",), "timeline": (JOB, RUN), "film": ("film.mp4",),
    "tables": ("tables.xlsx",),
}  # fmt: skip


def written(asked: str, loaded: Loaded, folder: Path, *, governing: str) -> Path:
    """Compute all load cases into the folder of a job, or a scenario into that of a run, and return what is asked for.

    The film is of the `governing` case. WireRopeError if it cannot be computed or written.
    """
    from wirerope_mj.runs.report import write_content_of, write_films, write_report  # half a second, not before it is asked for

    if loaded.texts:
        run_job(loaded.job, folder, pdf=asked == "pdf", workers=1)
        run = next(folder / CASES / case.folder for case in loaded.job.cases if case.name == governing)
    else:
        run, scenario = folder, loaded.job.cases[0].scenario
        system, motion = variant(loaded.job.system, scenario.motion, loaded.values)
        write_run(replace(scenario, motion=motion, changes=system.changes), folder, force=True)
        if asked == "pdf":
            write_report(folder, pdf=True)
    name = FILES[asked][0] if loaded.texts else FILES[asked][-1]
    if asked == "film":
        write_films([run], folder / name, force=True)
    elif asked == "tables":
        write_content_of(folder, folder / name, force=True)
    return folder / name
