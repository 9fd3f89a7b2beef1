"""Content on rest under gravity: sag and load of mounts and payloads, distribution of the weight, and tipping stability."""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from wirerope_mj.assessment.criteria import EXCEEDED, NOT_JUDGED, Verdict
from wirerope_mj.assessment.criteria.summary import pressed_lines, rested_lines, single_travel_lines, static_load_lines
from wirerope_mj.assessment.criteria.verdict import BOTTOMING, STATIC_LOAD, TRAVEL, most_used
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.numbers import with_unit
from wirerope_mj.content.verdicts import TONE
from wirerope_mj.dynamics.modes import TippingStability
from wirerope_mj.engine.statics import StaticTable
from wirerope_mj.foundation.errors import Absent
from wirerope_mj.foundation.tables import Column, Mark, Row, Table, left

# Descriptions of the two equilibria by loading history
HISTORIES = {"virgin": "on the first loading, as after installation", "relaxed": "after long vibration (friction relaxed)"}
RESTED_REMEDY = "The base moves the payload through them; give them a larger gap, or the mounts more stiffness."
_TONES = {"stable": "within", "slender": "near"}
_BALANCED = 1e-4  # fraction of the weight up to which loads on contacts and joints are not stated
_MORE_THAN_ALL = 1.000001  # ratio of all mounts' loads to the weight on mounts, above which payloads are stacked


def statics_content(
    name: str, table: StaticTable, verdicts: Sequence[Verdict], stability: Mapping[str, TippingStability]
) -> Content:
    """Compose the content of an equilibrium: sag, loads, verdicts, and stability."""
    return Content(
        title=f"{name}: at rest under gravity",
        verdict=_rested_statement(verdicts)
        or _static_load_statement(verdicts)
        or Statement("static-load", "Static load: not judged.", tone="unjudged"),
        sections=(
            Section("rested", "", lambda: [_rested_statement(verdicts)], "summary"),
            Section("statics", "", partial(statics_blocks, table, verdicts), "summary"),
            Section("stability", "", partial(stability_blocks, stability, verdicts), "summary"),
        ),
    )


def run_statics_blocks(run: JudgedRun) -> Iterator[Block | None]:
    if not run.response.scene.mounts:
        return
    if not run.gravity:
        yield Statement("statics", "The model has no gravity: the mounts carry nothing at rest.")
    elif isinstance(run.statics, Absent):
        yield Statement("statics", run.statics.reason, tone="unjudged")
    else:
        yield from statics_blocks(run.statics, [row for row in run.verdicts if row.criterion.kind == STATIC_LOAD])


def statics_blocks(table: StaticTable, verdicts: Sequence[Verdict]) -> Iterator[Block | None]:
    """Yield sag and load of every mount and payload, the distribution of the weight, and verdicts."""
    for history, reason in table.missing.items():
        yield Statement(f"statics-{history}", f"{history.capitalize()}: {reason}", tone="unjudged")
    static = {(row.subject, row.criterion.sense): row for row in verdicts if row.criterion.kind == STATIC_LOAD}
    yield _sag_table(table, static)
    payloads: list[Row] = [
        (name, history, row.mass, *map(float, (*row.displacement, *row.rotation)))
        for history, sag in table.sags.items()
        for name, row in sag.payloads.items()
    ]
    axes = [Column(axis, "mm", "z.3f") for axis in "xyz"] + [Column(f"about {axis}", "mrad", "z.3f") for axis in "xyz"]
    columns = [*left("payload", "history"), Column("mass", "kg", ".5g"), *axes]
    yield Table("payload-sag", "Displacement of the payloads' centres of mass, and their tilt", columns, payloads)
    for history, sag in table.sags.items():
        text = f"{history.capitalize()}: of {with_unit(sag.weight, 'N', digits=4)} of weight the mounts carry "
        text += with_unit(sag.on_mounts, "N", digits=4)
        for load, support in ((sag.on_contacts, "contacts"), (sag.elsewhere, "joints and their springs")):
            if abs(load) > _BALANCED * sag.weight:
                text += f", {support} {with_unit(load, 'N')}"
        yield Statement(f"weight-{history}", f"{text}.", values={"weight_N": sag.weight})
    if any(sum(row.carries for row in sag.mounts.values()) > _MORE_THAN_ALL * sag.on_mounts for sag in table.sags.values()):
        text = (
            "Payloads stand on payloads: fractions are of the weight of all of them, and the lower mounts carry what stands "
            "above as well, so they add up to more than 100 %."
        )
        yield Statement("stacked", text)
    yield _static_load_statement(verdicts)
    if rest := single_travel_lines(verdicts) + pressed_lines(verdicts):
        yield Statement("rest-travel", " ".join(rest), tone="exceeded" if _beyond_travel(verdicts) else "within")
    unjudged: dict[str, dict[str, None]] = {}  # names without repetition, in the order of the model
    for (subject, _), row in static.items():
        if row.limit is None and not math.isnan(row.value):
            unjudged.setdefault(row.note, {})[subject] = None
    for reason, names in unjudged.items():
        yield Statement("static-not-judged", f"Not judged, because {reason}: {', '.join(names)}.")


def stability_blocks(stability: Mapping[str, TippingStability], verdicts: Sequence[Verdict] = ()) -> Iterator[Statement]:
    """Yield the tipping stability of each equilibrium, and whether it is extrapolated."""
    beyond = _beyond_travel(verdicts)
    texts = {history: tipping.description for history, tipping in stability.items()}
    same = len(set(texts.values())) == 1
    for history, text in list(texts.items())[: 1 if same else None]:
        tipping = stability[history]
        yield Statement(
            "stability" if same else f"stability-{history}",
            f"Stability: {text}" if same else f"Stability, {history}: {text}",
            tone="unjudged" if beyond else _TONES.get(tipping.word, "exceeded"),
            values={"gravity_factor": tipping.gravity_factor, "rise_m": tipping.rise},
        )
    if beyond:
        text = "Position of rest and stability are extrapolated: mounts rest beyond the travel that they are rated for."
        yield Statement("rest-extrapolated", text, tone="exceeded")


def _beyond_travel(verdicts: Sequence[Verdict]) -> bool:
    return any(row.verdict == EXCEEDED for row in verdicts if row.criterion.kind in (TRAVEL, BOTTOMING))


def _sag_table(table: StaticTable, verdicts: Mapping[tuple[str, str], Verdict]) -> Table:
    """Tabulate sag, load, part of the weight and verdict of every mount, in each equilibrium."""
    columns = (
        *left("mount", "history"), Column("axial", "mm", "z.3f"),
        Column("across", "mm", "z.3f"), Column("axial\nload", "kN", "z.3f"), Column("carries", "kN", "z.3f"),
        Column("of the\nweight", "%", "z.1f"), Column("used", "%", "z.1f"), *left("verdict"),
    )  # fmt: skip
    rows: list[Row] = []
    for name in next(iter(table.sags.values())).mounts:
        if not any(name in sag.listed for sag in table.sags.values()):
            continue
        for history, sag in table.sags.items():
            row, judged = sag.mounts[name], verdicts.get((name, history))
            verdict = NOT_JUDGED if judged is None else judged.verdict
            axial, across = float(row.deflection[2]), math.hypot(*row.deflection[:2])
            cells = axial, across, float(row.force[2]), row.carries, row.split, row.utilisation
            rows.append((name, history, *cells, Mark(verdict, TONE[verdict])))
    return Table(
        "sag", "Sag and load of every mount", columns, rows,
        note="Axial: along the mount's own axis, negative in compression. Carries: what the mount pushes up with. Used: axial "
        "load in compression over the rated static load. "
        + " ".join(f"{history.capitalize()}: {HISTORIES[history]}." for history in table.sags),
    )  # fmt: skip


def _rested_statement(verdicts: Sequence[Verdict]) -> Statement | None:
    lines = rested_lines(verdicts)
    return Statement("rested", " ".join([*lines, RESTED_REMEDY]), tone="exceeded") if lines else None


def _static_load_statement(verdicts: Sequence[Verdict]) -> Statement | None:
    worst = most_used(row for row in verdicts if row.criterion.kind == STATIC_LOAD)
    if worst is None:
        return None
    return Statement("static-load", static_load_lines(verdicts)[0], tone=TONE[worst.verdict])
