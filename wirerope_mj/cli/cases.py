"""`wirerope cases`: the load cases of a job, what governs each limit, and one document of all of them."""

import sys
from pathlib import Path
from time import perf_counter

from wirerope_mj.cli.options import All, Flag, Integer

OF_A_CASE = 2.9e8  # memory [B] that a process takes in which a case is simulated, with its pages
BLANK_JOB = ("model", "case", "case.name", "case.half-sine")  # keys that a blank job has without a #


def cases(
    job: Path,
    *,
    out: Path | None = None,
    workers: Integer | None = None,
    pdf: Flag = False,
    docx: Flag = False,
    blank: Flag = False,
    every: All = False,
    force: Flag = False,
) -> int:
    """Simulate the load cases of a job: which case governs each limit, and one document of all of them.

    JOB.toml names the model, the load cases with their motions in the words of `wirerope shock`, the limits, and the data of
    the document. Each case is a run of its own. The same folder is brought up to date: what was interrupted goes on, and only
    cases whose inputs changed are simulated again.

    wirerope cases cabinet.toml --out runs/cabinet --pdf --docx

    `--blank` writes a job to fill in, with all that one may say.

    Args:
        job: file of the job.
        out: folder of the job; runs/NAME-OF-THE-FILE by default.
        workers: processes that simulate side by side; one for each processor by default.
        pdf: write the report as a PDF, too, which needs the extra "pdf" (Typst).
        docx: write it as a DOCX, too, which needs the extra "docx" (python-docx).
        blank: write JOB.toml as a form to fill in, and simulate nothing.
        force: simulate every case again; with --blank replace the file.
    """
    from rich.markup import escape

    from wirerope_mj.cli.tables import DOCUMENT, TIMELINE, say_next, say_where
    from wirerope_mj.content.job import job_content
    from wirerope_mj.content.numbers import several
    from wirerope_mj.engine.simulation.progress import Estimate, time_left
    from wirerope_mj.foundation.interrupts import resumed_by
    from wirerope_mj.foundation.processes import processors
    from wirerope_mj.runs.job import CASES, run_job
    from wirerope_mj.runs.job_file import load_job
    from wirerope_mj.views.terminal import console, show, show_result

    if blank:
        from wirerope_mj.cli.isolators import write_form
        from wirerope_mj.foundation.schema import blank_form
        from wirerope_mj.runs.job_file import JobFile

        if out is not None or workers is not None or pdf or docx:
            raise ValueError("`--blank` writes a job to fill in, which goes with `--force` alone.")
        title = f"Load cases of one installation, their limits and their document: `wirerope cases {job.name}` simulates them."
        write_form(blank_form(JobFile, filled=BLANK_JOB, title=title), job, force=force)
        return 0
    if workers is not None and workers < 1:
        raise ValueError(f"`--workers` must be an integer >= 1, got {workers}.")
    began = perf_counter()
    read = load_job(job)
    folder = out or Path("runs") / job.stem
    screen = console()
    screen.print(f"\n[bold]{escape(read.name)}[/]  {several(len(read.cases), 'load case')}")

    count, used = 0, min(workers or processors(), len(read.cases))
    estimate = Estimate("cases", memory=used * OF_A_CASE)

    def done(name: str, seconds: float, answer: str, left: int) -> None:
        nonlocal count
        count += 1
        verdict, fraction = answer.partition(":")[0], count / (count + left)
        rest = f"{left} left, {time_left(fraction, perf_counter() - estimate.began)}" if left else "0 left"
        screen.print(f"  {escape(name)}: {escape(verdict)} [dim]{seconds:.1f} s, {rest}[/]", soft_wrap=True)
        sys.stdout.flush()
        written = sum(path.stat().st_size for path in (folder / CASES).rglob("*") if path.is_file())
        estimate.disk = written / fraction
        estimate.update(fraction)

    remedy = f"the cases that are done are kept in {folder}; the same command goes on."
    resumed_by(lambda: remedy)
    try:
        result = run_job(read, folder, force=force, workers=workers, pdf=pdf, docx=docx, done=done)
    except KeyboardInterrupt:
        raise KeyboardInterrupt(remedy) from None
    kept = [case.name for case in read.cases if case.name not in result.computed]
    why = "; ".join(f"{name}: {reason}" for name, reason in result.computed.items())
    screen.print(f"  computed {len(result.computed)} ({escape(why) or 'none'}), kept {len(kept)}", soft_wrap=True)
    others = sorted({path.name for path in (folder / CASES).iterdir()} - {case.folder for case in read.cases})
    if others:
        screen.print(f"  no longer in the job, and left as they are: {escape(', '.join(others))}", soft_wrap=True)
    content = job_content(result.job)
    show(content, "warnings")
    show_result(content, "brief", others=("limits", "required-spectra"), every=every)
    say_where(folder, seconds=perf_counter() - began, every=every)
    say_next({("show", folder / "job.rrd"): f"{TIMELINE} of every case", ("report", folder, "--pdf"): DOCUMENT})
    return 0
