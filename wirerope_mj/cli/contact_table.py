"""The table of stops and other contacts that `wirerope run` prints."""

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.assessment.criteria import STRUCK, contact_verdicts
from wirerope_mj.engine.response import Response


def contact_table(response: Response) -> Table | None:
    """Return first touch, peak force, penetration and verdict of every stop and pair that touched; None if none did."""
    contacts = response.peaks.contacts or {}
    rows = [(row, contacts[row.subject]) for row in contact_verdicts(response) if contacts[row.subject].touches]
    if not rows:
        return None
    table = Table(
        box=box.SIMPLE_HEAD,
        title="Stops and contacts",
        title_style="bold",
        title_justify="left",
        show_edge=False,
        padding=(0, 1, 0, 0),
    )
    table.add_column("stop or pair", overflow="fold")
    for head in ("first\n[s]", "\ntouches", "in all\n[ms]", "peak\n[kN]", "at\n[s]", "depth\n[mm]"):
        table.add_column(escape(head), justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for verdict, contact in rows:
        when = "-" if contact.force_time is None else f"{contact.force_time:.4f}"
        table.add_row(
            escape(contact.called(verdict.subject)), f"{contact.first_touch:.4f}", str(contact.touches),
            f"{1e3 * contact.duration:.1f}", f"{1e-3 * contact.force:.2f}", when, f"{1e3 * contact.penetration:.2f}",
            f"[bold red]{verdict.verdict}[/]" if verdict.verdict == STRUCK else verdict.verdict,
        )  # fmt: skip
    return table
