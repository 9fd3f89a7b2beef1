"""The report of a run, from its folder alone: what the run does not hold, statics, modes and spectra, is computed here."""

from collections.abc import Mapping
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from wirerope_mj.dynamics.modes import modes
from wirerope_mj.engine.response import Response, load_response
from wirerope_mj.engine.statics.loading import HISTORIES
from wirerope_mj.engine.system import System
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions import BaseMotion
from wirerope_mj.motions.records.record import record_warnings
from wirerope_mj.runs.checksums import update_checksums, warn_of_alterations
from wirerope_mj.runs.frequency_response import KIND, MARKS
from wirerope_mj.runs.judged import JudgedRun, judged_run, result_or_absent
from wirerope_mj.runs.page import page_files, write_page
from wirerope_mj.runs.run_spectra import RunSpectra, spectra_of
from wirerope_mj.runs.scenario_file import scenario_content
from wirerope_mj.runs.sources import check_one_run, system_and_motion
from wirerope_mj.views.report import FinishedRun, report_content, report_html
from wirerope_mj.views.selection import Selection, select


def write_report(
    folder: str | Path, *, out: str | Path | None = None, pdf: bool = False, force: bool = False
) -> list[Path]:
    """Write the report of a run and return the files, the page first.

    Args:
        folder: of the run; nothing outside it is read.
        out: the page, .html; by default report.html in the run's folder, which is made anew.
        pdf: whether a PDF of the page is written beside it.
        force: whether files at `out` are replaced.

    Raises:
        RecordError: the folder is not a run, its files are damaged or not of one run, or a file is there and must not be
            replaced.
        WireRopeError: a PDF cannot be made here.
    """
    folder = Path(folder)
    files = page_files(folder, out, pdf=pdf, force=force)
    warn_of_alterations(_run_folder(folder))
    content = scenario_content(folder)
    system, motion = system_and_motion(folder, content)
    response = load_response(folder)
    check_one_run(folder, content, system, response)
    write_page(report_page(content, system, motion, response, judged_run(system, response)), files)
    update_checksums(folder, files)
    return files


def report_page(
    content: Mapping[str, Any],
    system: System,
    motion: BaseMotion,
    response: Response,
    judged: JudgedRun,
    selection: Selection | None = None,
    spectra: RunSpectra | None = None,
) -> str:
    """Return the report of a run as one HTML page.

    Args:
        content: of scenario.toml.
        system: that was simulated.
        motion: of its base.
        response: what came out.
        judged: verdicts on it.
        selection: what is shown of it; made here if it is not given.
        spectra: of the run, in the same way.
    """
    arguments, written = content["simulate"], content.get("written")
    initial = str(arguments.get("initial", "settled"))
    gravity = float(np.linalg.norm(system.model.opt.gravity))
    histories = HISTORIES if gravity else HISTORIES[:1]  # without a load there is nothing to relax
    spectra = spectra or spectra_of(motion, response, float(arguments["sample_rate"]))
    run = FinishedRun(
        name=str(content.get("name", response.scene.name)),
        question=str(content.get("question", "")),
        written=f"{written:%Y-%m-%d %H:%M} UTC" if isinstance(written, datetime) else "at an unknown time",
        model=Path(content["model"]["file"]).name,
        options=content.get("options", {}),
        initial=initial,
        duration=float(arguments["duration"]),
        sample_rate=float(arguments["sample_rate"]),
        motion=motion,
        record_warnings=record_warnings(motion),
        response=response,
        isolators={name: mount.written for name, mount in system.mounts.items()},
        gravity=gravity,
        statics=judged.statics,
        modes={history: result_or_absent(partial(modes, system, history=history)) for history in histories},
        spectra=spectra.shock,
        densities=spectra.densities,
        spectra_held=spectra.held,
        verdicts=judged.verdicts,
        random=judged.random,
        untested=judged.untested,
        model_warnings=judged.model_warnings,
        versions=content.get("versions", {}),
        selection=selection or select(response, judged.verdicts),
    )
    return report_html(report_content(run))


def _run_folder(folder: Path) -> Path:
    """Return the folder; RecordError if it is something else than a run."""
    if not folder.is_dir():
        raise RecordError(
            f"{folder}: there is no such folder; a report is made of the folder that `wirerope run` wrote."
        )
    if all((folder / mark).is_file() for mark in MARKS):
        raise RecordError(
            f"{folder}: this is a {KIND}, whose pictures and tables stand in its folder; reports are made of runs."
        )
    return folder
