"""Blocks of a report about measured records: their warnings, and the correction of their baselines."""

from wirerope_mj.foundation.tables import Column, Table
from wirerope_mj.motions import Record
from wirerope_mj.motions.records.record import records_in
from wirerope_mj.views.display import listed
from wirerope_mj.views.plots.record_baseline import baseline_text
from wirerope_mj.views.plots.report_record import ends, record_chart
from wirerope_mj.views.report.content import Block, Listing, Paragraph, Picture
from wirerope_mj.views.report.run import FinishedRun


def warnings_of(run: FinishedRun) -> list[Block]:
    """Return the warnings of the records that were played; nothing if there are none."""
    if not run.record_warnings:
        return []
    return [
        Paragraph(text="Said of the measured record, on which every figure here rests:", tone="unjudged"),
        Listing(items=run.record_warnings),
    ]


def record_blocks(run: FinishedRun) -> list[Block]:
    """Return the warnings of the records in the base's motion, and the baseline correction of each."""
    blocks = warnings_of(run)
    for record in records_in(run.motion):
        if record.baseline == "none":
            blocks.append(Paragraph(text=f"Record {record.path.name}, {baseline_text(record)}."))
        else:
            blocks += _correction(record)
    return blocks


def _correction(record: Record) -> list[Block]:
    """Return picture and ends of a record without its baseline correction and with it."""
    measured = record.as_measured
    axes = [axis for axis in range(3) if measured.samples[:, axis].any()]
    rows = []
    for axis in axes:
        for one, text in ((measured, "as measured"), (record, "as played")):
            velocity, displacement = ends(one)
            peak = float(abs(one.samples[:, axis]).max())
            rows.append(("xyz"[axis], text, peak, float(velocity[axis]), float(displacement[axis])))
    along = listed(["xyz"[axis] for axis in axes])
    return [
        Picture(
            image=record_chart(measured, record),
            caption=f"The whole record {record.path.name} along {along}, as measured and as it is played, "
            f"{baseline_text(record)}.",
            alt=f"Histories of {record.path.name} along {along}, without the baseline correction and with it.",
        ),
        Table(
            title="What the baseline correction changes",
            columns=(
                Column("axis", align="left"), Column("record", align="left"), Column("largest acceleration", "g"),
                Column("velocity at its end", "m/s"), Column("displacement at its end", "mm"),
            ),
            rows=rows,
        ),
    ]  # fmt: skip
