"""A run against measured tests: their files in its folder, a page and a recording with all curves over each other."""

from collections.abc import Mapping
from pathlib import Path

from wirerope_mj.assessment.correlation import Correlation, correlate
from wirerope_mj.content.correlation import correlation_content
from wirerope_mj.content.judged_run import RunResult
from wirerope_mj.engine.response import load_response
from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.motions import load_measured
from wirerope_mj.runs.folder import update_checksums, warn_of_alterations
from wirerope_mj.runs.measured import store_test
from wirerope_mj.runs.sources import is_run, run_verdicts
from wirerope_mj.views.report import report_html


def write_correlation(
    folder: Path, files: Mapping[str, Path], options: Entries, page: Path, *, force: bool
) -> tuple[Correlation, ...]:
    """Compare a run with tests, keep their files in its folder, and write a page, and a recording beside it.

    Args:
        folder: of the run.
        files: of the tests by their names.
        options: as `load_measured` takes them, channels included.
        page: to write, .html.
        force: whether other tests of the same names are replaced.

    Raises:
        RecordError: the folder is no run, a test cannot be read, or it was measured at what the run does not have.
    """
    if not is_run(folder):
        raise RecordError(f"{folder}: this is no run. Tests are compared with the folder that `wirerope run` or `shock` wrote.")
    warn_of_alterations(folder)
    response = load_response(folder)
    measured = [load_measured(file, name=name, **options) for name, file in files.items()]
    tests = tuple(correlate(response, one) for one in measured)
    for one in measured:
        store_test(folder, one, force=force)
    content = correlation_content(folder.resolve().name, tests)
    with atomic_file(page) as beside:
        beside.write_text(report_html(content), encoding="utf-8")
    from wirerope_mj.views.recording.record import record_run  # late: rerun takes long to import

    recording = page.with_suffix(".rrd")
    run = RunResult(response=response, verdicts=run_verdicts(folder, response))
    record_run(run, recording, title=content.title, scenario_text=content.verdict.text, tests=tests)
    update_checksums(folder, [page, recording])
    return tests
