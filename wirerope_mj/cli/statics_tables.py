"""What `wirerope statics` prints: mounts and payloads under the weight, loads against ratings, distance from tipping over."""

import math
from collections.abc import Iterator, Sequence

from rich import box
from rich.markup import escape
from rich.table import Table

from wirerope_mj.assessment.criteria import Verdict
from wirerope_mj.cli.screen import console
from wirerope_mj.dynamics.modes import TippingStability
from wirerope_mj.engine.statics import Sag, StaticTable

_FAR = 100.0
"""Gravity factor and rise [m] from which both say no more than: far."""


def print_statics(
    name: str, table: StaticTable, verdicts: Sequence[Verdict], stability: dict[str, TippingStability]
) -> None:
    """Print where a system rests."""
    screen = console()
    screen.print()
    screen.print(_mounts(name, table, verdicts))
    screen.print()
    screen.print(_payloads(table))
    screen.print()
    for sentence in _sentences(table, verdicts, stability):
        screen.print(f"  {sentence}", soft_wrap=True, markup=False)


def stability_words(stability: TippingStability) -> str:
    """Return a sentence on how far a system is from tipping over."""
    if stability.word == "tips over":
        return "it tips over: its mounts do not hold its weight upright."
    if stability.word == "not held":
        return "something moves without any stiffness: no mount, joint or stop holds it."
    if stability.gravity_factor > _FAR and stability.rise > _FAR:
        return f"{stability.word}, far from tipping over."
    ways = []
    if math.isfinite(stability.gravity_factor):
        ways.append(f"at {stability.gravity_factor:.3g} times its weight")
    if math.isfinite(stability.rise):
        ways.append(f"with its centre of mass, or that of a part on a joint, {stability.rise:.3g} m higher")
    return f"{stability.word}; it would tip over {', or '.join(ways)}."


def _mounts(name: str, table: StaticTable, verdicts: Sequence[Verdict]) -> Table:
    """Return the table of the mounts."""
    headings = [
        "axial\n[mm]",
        "across\n[mm]",
        "axial load\n[kN]",
        "carries\n[kN]",
        "of the weight\n[%]",
        "of the rating\n[%]",
    ]
    histories = " / ".join(table.sags)
    found = plain_table(f"{name}: mounts under the weight, {histories}; negative is compression", "mount", headings)
    found.add_column("verdict", no_wrap=True)
    exceeded = {verdict.subject for verdict in verdicts if verdict.verdict == "exceeded"}
    judged = {verdict.subject for verdict in verdicts if verdict.limit is not None}
    for mount in next(iter(table.sags.values())).mounts:
        if not any(mount in sag.listed for sag in table.sags.values()):
            continue
        columns = zip(*(_cells(sag, mount) for sag in table.sags.values()), strict=True)
        word = "[bold red]exceeded[/]" if mount in exceeded else "within" if mount in judged else "not judged"
        found.add_row(escape(mount), *[" / ".join(column) for column in columns], word)
    return found


def _cells(sag: Sag, mount: str) -> Iterator[str]:
    row = sag.mounts[mount]
    yield f"{1e3 * row.deflection[2]:z.3f}"
    yield f"{1e3 * math.hypot(*row.deflection[:2]):.3f}"
    yield f"{1e-3 * row.force[2]:z.3f}"
    yield f"{1e-3 * row.carries:z.3f}"
    yield f"{100 * row.split:z.1f}" if math.isfinite(row.split) else "-"
    yield "-" if row.share is None else f"{100 * row.share:.1f}"


def _payloads(table: StaticTable) -> Table:
    headings = ["mass\n[kg]", "x [mm]", "y [mm]", "z [mm]", "about x\n[mrad]", "about y\n[mrad]", "about z\n[mrad]"]
    found = plain_table("Payloads: way of the centre of mass, tilt and turn", "payload", ["history", *headings])
    for history, sag in table.sags.items():
        for name, row in sag.payloads.items():
            move = [f"{1e3 * value:z.3f}" for value in (*row.displacement, *row.rotation)]
            found.add_row(escape(name), history, f"{row.mass:.5g}", *move)
    return found


def plain_table(title: str, first: str, numbers: list[str]) -> Table:
    """Return a table of one column of names and columns of numbers."""
    found = Table(box=box.SIMPLE_HEAD, title=escape(title), title_style="bold", title_justify="left", show_edge=False)
    found.padding = (0, 1, 0, 0)
    found.add_column(escape(first), no_wrap=True)
    for name in numbers:
        found.add_column(escape(name), justify="right", no_wrap=True)
    return found


def _sentences(
    table: StaticTable, verdicts: Sequence[Verdict], stability: dict[str, TippingStability]
) -> Iterator[str]:
    for history, sag in table.sags.items():
        rest = "" if abs(sag.elsewhere) < 1e-6 * abs(sag.weight) else f", joints {1e-3 * sag.elsewhere:.4f} kN"
        yield (
            f"{history}: of the weight of {1e-3 * sag.weight:.4f} kN mounts carry {1e-3 * sag.on_mounts:.4f} kN, "
            f"contacts {1e-3 * sag.on_contacts:.4f} kN{rest}."
        )
    if any(sum(row.carries for row in sag.mounts.values()) > 1.000001 * sag.on_mounts for sag in table.sags.values()):
        yield (
            "Payloads stand on payloads: shares are of the weight of all of them, and the lower mounts carry what stands above "
            "as well, so they add up to more than 100 %."
        )
    for history, words in table.missing.items():
        yield f"{history}: {words}"
    judged = [verdict for verdict in verdicts if verdict.utilisation is not None]
    if judged:
        worst = max(judged, key=lambda verdict: verdict.utilisation or 0.0)
        yield (
            f"{worst.subject} has most of its rated static load: {100 * (worst.utilisation or 0.0):.1f} % "
            f"({worst.criterion}): {worst.verdict}."
        )
    unjudged: dict[str, dict[str, None]] = {}  # names without repetition, in the order of the model
    for verdict in verdicts:
        if verdict.limit is None:
            unjudged.setdefault(verdict.note, {})[verdict.subject] = None
    for reason, names in unjudged.items():
        yield f"Not judged, because {reason}: {', '.join(names)}."
    said = {history: stability_words(figures) for history, figures in stability.items()}
    if len(set(said.values())) == 1:
        said = {" and ".join(said): next(iter(said.values()))}
    for history, sentence in said.items():
        yield f"{history}: {sentence}"
