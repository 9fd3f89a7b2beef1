"""What the report of a run is made of."""

import pytest

from wirerope_mj.content.run import run_content
from wirerope_mj.runs import report as report_module
from wirerope_mj.runs.report import write_report


def finished_of(folder):
    """Return the judged run that its report is made of."""
    seen = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "run_content", lambda run: seen.append(run) or run_content(run))
        write_report(folder)
    return seen[0]
