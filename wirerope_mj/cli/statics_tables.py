"""Tables of `wirerope statics`: mounts and payloads under the weight, loads against ratings, distance from tipping over."""

import math
from collections.abc import Iterator, Sequence

from wirerope_mj.assessment.criteria import EXCEEDED, NOT_JUDGED, WITHIN, Verdict
from wirerope_mj.assessment.criteria.sentences import static_load_lines
from wirerope_mj.dynamics.modes import TippingStability
from wirerope_mj.engine.statics import Sag, StaticTable
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table
from wirerope_mj.views.terminal import console, print_lines, print_table

_MOUNT_COLUMNS = (
    Column("axial", "mm", "z.3f"),
    Column("across", "mm", ".3f"),
    Column("axial load", "kN", "z.3f"),
    Column("carries", "kN", "z.3f"),
    Column("of the weight", "%", "z.1f"),
    Column("of the rating", "%", ".1f"),
)


def print_statics(
    name: str, table: StaticTable, verdicts: Sequence[Verdict], stability: dict[str, TippingStability]
) -> None:
    """Print the equilibrium of a system."""
    for part in (_mounts(name, table, verdicts), _payloads(table)):
        console().print()
        print_table(part)
    console().print()
    print_lines(_sentences(table, verdicts, stability))


def _mounts(name: str, table: StaticTable, verdicts: Sequence[Verdict]) -> Table:
    exceeded = {verdict.subject for verdict in verdicts if verdict.verdict == EXCEEDED}
    judged = {verdict.subject for verdict in verdicts if verdict.limit is not None}
    sags = list(table.sags.values())
    rows: list[Row] = []
    for mount in sags[0].mounts:
        if not any(mount in sag.listed for sag in sags):
            continue
        values = zip(*(_values(sag, mount) for sag in sags), strict=True)
        cells = [" / ".join(map(column.text, of)) for column, of in zip(_MOUNT_COLUMNS, values, strict=True)]
        verdict: Cell = WITHIN if mount in judged else NOT_JUDGED
        rows.append([mount, *cells, Mark(EXCEEDED, "exceeded") if mount in exceeded else verdict])
    return Table(
        title=f"{name}: mounts under the weight, {' / '.join(table.sags)}; negative is compression",
        columns=(Column("mount", align="left"), *_MOUNT_COLUMNS, Column("verdict", align="left")),
        rows=rows,
    )


def _values(sag: Sag, mount: str) -> tuple[float | None, ...]:
    row = sag.mounts[mount]
    return (
        row.deflection[2], math.hypot(*row.deflection[:2]), row.force[2], row.carries, row.split, row.utilisation,
    )  # fmt: skip


def _payloads(table: StaticTable) -> Table:
    return Table(
        title="Payloads: displacement of the centre of mass, tilt and turn",
        columns=(
            Column("payload", align="left"),
            Column("history", align="left"),
            Column("mass", "kg", ".5g"),
            *(Column(axis, "mm", "z.3f") for axis in "xyz"),
            *(Column(f"about {axis}", "mrad", "z.3f") for axis in "xyz"),
        ),
        rows=[
            [name, history, row.mass, *row.displacement, *row.rotation]
            for history, sag in table.sags.items()
            for name, row in sag.payloads.items()
        ],
    )


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
            "Payloads stand on payloads: fractions are of the weight of all of them, and the lower mounts carry what stands "
            "above as well, so they add up to more than 100 %."
        )
    for history, reason in table.missing.items():
        yield f"{history}: {reason}"
    yield from static_load_lines(verdicts)
    unjudged: dict[str, dict[str, None]] = {}  # names without repetition, in the order of the model
    for verdict in verdicts:
        if verdict.limit is None:
            unjudged.setdefault(verdict.note, {})[verdict.subject] = None
    for reason, names in unjudged.items():
        yield f"Not judged, because {reason}: {', '.join(names)}."
    texts = {history: values.description for history, values in stability.items()}
    if len(set(texts.values())) == 1:
        texts = {" and ".join(texts): next(iter(texts.values()))}
    for history, text in texts.items():
        yield f"{history}: {text}"
