"""What the report of a run is made of."""

import pytest

from wirerope_mj.runs import report as report_module
from wirerope_mj.runs.report import write_report
from wirerope_mj.views.report import report_content


def finished_of(folder):
    """Return what the report of a run is made of."""
    seen = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "report_content", lambda run: seen.append(run) or report_content(run))
        write_report(folder)
    return seen[0]
