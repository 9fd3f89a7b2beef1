"""What a board writes for its page to open: the folder of a job or a run, and what is made of it, by another process."""

from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.foundation.errors import WireRopeError
from wirerope_mj.runs.job import CASES, run_job
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.runs.write import write_run

JOB, RUN = "job.rrd", "run.rrd"  # recordings
# What can be asked for, with the files that it is in the folder of a job or of a run
FILES = {
    "report": ("report.html",), "pdf": ("report.pdf",), "timeline": (JOB, RUN), "film": ("film.mp4",),
    "tables": ("tables.xlsx",),
}  # fmt: skip


@dataclass(frozen=True)
class Order:
    """A request to write a key of `FILES`, such as a report or a film, of a job's file or a scenario into a folder."""

    asked: str
    of: Path | Scenario
    folder: Path
    governing: str  # load case of which a film is

    def write_beside(self) -> Future[Path | str]:
        """Have another process compute and write the file; the result is its path, or why there is none."""
        from wirerope_mj.studies.engines.local import futures_of_processes  # late: with it comes all that studies need

        return futures_of_processes(_write, [self])[0]


def _write(order: Order) -> Path | str:
    """Compute all load cases into the folder of a job, or a scenario into that of a run, and what is asked for beside them."""
    from wirerope_mj.runs.report import write_content_of, write_films, write_report  # half a second, not before it is asked for

    asked, folder = order.asked, order.folder
    try:
        if isinstance(order.of, Scenario):
            run, name = folder, FILES[asked][-1]
            write_run(order.of, folder, force=True)
            if asked == "pdf":
                write_report(folder, pdf=True)
        else:
            job, name = load_job(order.of), FILES[asked][0]
            run_job(job, folder, pdf=asked == "pdf", workers=1)
            run = folder / CASES / max(job.cases, key=lambda case: case.name == order.governing).folder
        if asked == "film":
            write_films([run], folder / name, force=True)
        elif asked == "tables":
            write_content_of(folder, folder / name, force=True)
    except (WireRopeError, ValueError, OSError) as error:
        return str(error)
    return folder / name
