"""What the report of a run is made of."""

from dataclasses import replace

import pytest

from wirerope_mj.content.run import run_content
from wirerope_mj.foundation.tables import Table
from wirerope_mj.runs import report as report_module
from wirerope_mj.runs.report import write_report


def finished_of(folder):
    """Return the judged run that its report is made of."""
    seen = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_module, "run_content", lambda run: seen.append(run) or run_content(run))
        write_report(folder)
    return seen[0]


def with_parts(run, **changes):
    """Return a judged run with other parts, also those that it computes when they are first asked for."""
    fields = {name: value for name, value in changes.items() if name in run.__dataclass_fields__}
    changed = replace(run, **fields)
    vars(changed).update({name: value for name, value in changes.items() if name not in fields})
    return changed


def tables_of(content):
    """Return all tables of a content by their ids."""
    return {block.id: block for block in content.blocks() if isinstance(block, Table)}
