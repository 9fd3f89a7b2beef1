"""Content of a job: the load case that governs each limit, envelopes over the cases, and each case by itself."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from wirerope_mj.assessment.criteria import COMBINED, NOT_JUDGED, STRUCK, Verdict
from wirerope_mj.assessment.criteria.judge import FAIL, PASS, UNKNOWN, amplified_text, contacts, critical_text, fail_text, scope
from wirerope_mj.assessment.criteria.summary import OWN_RULE
from wirerope_mj.assessment.criteria.verdict import ACCELERATION, RATTLE_SPACE, criterion_text, most_amplified, most_used
from wirerope_mj.content.blocks import Block, Content, Document, Section, Statement
from wirerope_mj.content.first_sheet import first_charts
from wirerope_mj.content.job_envelope import envelope_blocks
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import devices_of, model_blocks
from wirerope_mj.content.modes import run_modes_blocks
from wirerope_mj.content.numbers import listed, several, shown, shown_unit, with_unit
from wirerope_mj.content.required_spectra import pairs_table, required_statement, spectra_chart, spectra_table
from wirerope_mj.content.run import START, run_content
from wirerope_mj.content.scene_outline import worst_instant
from wirerope_mj.content.statics import run_statics_blocks
from wirerope_mj.content.verdicts import TONE, headline, open_statement, unjudged, used_mark, used_tone, verdict_bars
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left

# Sections of a run that a case of a job may show; the first seven by default
REPORTED = (
    "accelerations", "mounts", "contacts", "payload", "mounts-in-motion", "deck", "verdicts",
    "grounds", "base", "contact-histories", "numerics",
)  # fmt: skip

STATED = "Stated by the author: "  # put before what no computation supports
_SHOWN_LIMITS = 12  # limits that are shown before the others are folded away, or go into an appendix
# Kinds of limits of the payload, which stand before those of the mounts
_PAYLOAD_LIMITS = (ACCELERATION, RATTLE_SPACE)


@dataclass(frozen=True, kw_only=True)
class JudgedCase:
    """A load case that was simulated and judged; `note` describes its origin."""

    name: str
    folder: str
    note: str
    run: JudgedRun


@dataclass(frozen=True, kw_only=True)
class JudgedJob:
    """A job whose load cases were simulated and judged."""

    name: str
    question: str  # that the job answers
    cases: tuple[JudgedCase, ...]  # in the order of the job
    report: tuple[str, ...]  # sections of a run that each case shows, of `REPORTED`
    document: Document | None  # data of the document; None for a plain report
    written: str  # date and time of the simulation

    @property
    def runs(self) -> dict[str, JudgedRun]:
        """The runs by the names of their cases."""
        return {case.name: case.run for case in self.cases}

    @property
    def verdicts(self) -> dict[str, tuple[Verdict, ...]]:
        return {case.name: case.run.verdicts for case in self.cases}


def job_content(job: JudgedJob) -> Content:
    """Compose the content of a job: answer, limits, envelopes and basis, then each load case."""

    def warnings_said() -> Iterator[Block]:
        warnings = dict.fromkeys(text for run in job.runs.values() for text in run.model_warnings)
        for number, warning in enumerate(warnings, start=1):
            yield Statement(f"model-warning-{number}", f"warning: {warning}", tone="unjudged")

    def answers() -> Iterator[Block]:
        yield Statement("cases-answers", items=tuple(f"{name}: {text}" for name, text in answers_of(job.verdicts).items()))

    def required() -> Iterator[Block]:
        made = {case.name: case for case in job.cases if case.run.achieved}
        for name, case in made.items():
            said = required_statement(case.run)
            yield replace(said, id=f"{case.folder}/{said.id}", text=f"{name}: {said.text}")
        if made:
            yield spectra_table({name: case.run.achieved for name, case in made.items()})
        if pairs := {name: case.run.axis_pairs for name, case in made.items() if case.run.axis_pairs}:
            yield pairs_table(pairs)
        for name, case in made.items():
            chart = spectra_chart(case.run.achieved)
            yield replace(chart, id=f"{case.folder}/{chart.id}", caption=f"{name}. {chart.caption}")

    def limits() -> Iterator[Block | None]:
        yield matrix_table(job.verdicts)
        yield governing_table(job.verdicts)
        reasons = dict.fromkeys(text for rows in job.verdicts.values() for text in unjudged(rows))
        yield Statement("not-judged", "Not judged:", items=tuple(reasons), tone="unjudged") if reasons else None

    def case_blocks(case: JudgedCase) -> Iterator[Block]:
        yield replace(headline(case.run.verdicts), id=f"{case.folder}/headline")
        yield Statement(f"{case.folder}/motion", f"{case.run.acting}. {case.note}".strip(), tone="quiet")
        yield from _run_blocks(case, {"answer", "random", *job.report} - {"verdicts"})

    first, document = job.cases[0].run, job.document
    texts = document.paragraphs if document else lambda name: []
    sections = [
        Section("warnings", "", warnings_said, "headline"),
        Section("brief", "", partial(brief, job), "headline"),
        Section("answer", "", answers, "headline"),
        Section("scope", "Scope", lambda: stated("scope", texts("scope"))),
        Section("limits", "Limits and what governs them", limits, "summary"),
        Section("load-cases", "Load cases", partial(_cases, job)),
        Section("required-spectra", "Required and achieved spectra", required, "summary"),
        Section("envelope", "Envelope over all load cases", lambda: envelope_blocks(job.runs)),
        Section("conclusion", "Conclusion", lambda: stated("conclusion", texts("conclusion"))),
        Section(
            "basis", "What is assumed, and what was validated",
            lambda: basis_blocks(job.runs, texts("assumptions"), texts("validation")),
        ),
        Section("model", "Model and mounts", partial(model_blocks, first)),
        Section("statics", "At rest under gravity", partial(run_statics_blocks, first)),
        Section("modes", "Modes", partial(run_modes_blocks, first)),
    ]  # fmt: skip
    for case in job.cases:
        sections.append(Section(f"case-{case.folder}", f"Load case: {case.name}", partial(case_blocks, case)))
    for case in job.cases if "verdicts" in job.report else ():
        blocks = partial(_run_blocks, case, ("verdicts",))
        sections.append(Section(f"verdicts-{case.folder}", f"All verdicts of {case.name}", blocks, appendix=True))
    version = first.inputs.get("versions", {}).get("wirerope-mj", "unknown")
    return Content(
        title=job.name, document=document, question=(job.question,), verdict=job_headline(job.verdicts),
        sections=tuple(sections),
        facts=(
            ("Model", first.model_file), ("Load cases", str(len(job.cases))), ("Simulated", job.written),
            ("By", f"wirerope-mj {version}"),
        ),
    )  # fmt: skip


def brief(job: JudgedJob) -> Iterator[Block | None]:
    """Yield the load cases as bars, worst instant and charts of the one that governs, and what is not judged."""
    for case in job.cases:
        if case.run.achieved:
            said = required_statement(case.run)
            yield replace(said, id=f"{case.folder}/required", text=f"{case.name}: {said.text}", items=())
    worst = {name: row for name, rows in job.verdicts.items() if (row := most_used(rows))}
    named = ((name, f"{row.subject} {criterion_text(row.criterion)}", row) for name, row in worst.items())
    yield verdict_bars("load case", named)
    critical = most_used(worst.values())
    governing = next((case for case in job.cases if worst.get(case.name) is critical), job.cases[0])
    scene, charts = worst_instant(governing.run), first_charts(governing.run)
    yield scene and replace(scene, caption=f"{governing.name}. {scene.caption}")
    others = [f"{name}: {text}" for name, text in answers_of(job.verdicts).items() if text.startswith(UNKNOWN)]
    yield Statement("cases-open", items=tuple(others), tone="unjudged")
    yield open_statement(row for rows in job.verdicts.values() for row in rows)
    yield charts and replace(charts, caption=f"{governing.name}. {charts.caption}")


def answers_of(verdicts: Mapping[str, Sequence[Verdict]]) -> dict[str, str]:
    return {name: headline(rows).text for name, rows in verdicts.items()}


def job_headline(verdicts: Mapping[str, Sequence[Verdict]]) -> Statement:
    """State the verdict of a job: the load cases that exceed a limit, and the most critical limit with its case."""
    every = [row for rows in verdicts.values() for row in rows]
    answers = answers_of(verdicts)
    over = [name for name, text in answers.items() if text.startswith(FAIL)]
    open_cases = [name for name, text in answers.items() if text.startswith(UNKNOWN)]
    judged = sum(row.utilisation is not None for row in every)
    worst = most_used(every)
    where = next((name for name, rows in verdicts.items() if worst in rows), "")
    used = "" if worst is None else f"{critical_text(every)}, in {where}"
    count, (restriction, missing) = several(len(verdicts), "load case"), scope(every)
    if over:
        text = fail_text(f"{len(over)} of {count} {'exceeds' if len(over) == 1 else 'exceed'} a limit", every, f", in {where}")
        text += f"; {listed(open_cases)} not judged" if open_cases else ""
        tone = "exceeded"
    elif open_cases or worst is None:
        text, tone = f"{UNKNOWN}: of {count} {listed(open_cases) or 'none'} cannot be judged", "unjudged"
        text += f"; most critical {used}" if used else ""
    else:
        text = f"{PASS}{restriction}: most critical {used}; all {several(judged, 'check')} in {count} are within limits"
        tone = "unjudged" if restriction else used_tone(worst.utilisation)
    struck: dict[tuple[str, str], list[str]] = {}  # load cases by what is struck in them
    for name, rows in verdicts.items():
        for thing, does, outcomes in contacts(rows):
            if STRUCK in outcomes:
                struck.setdefault((thing, does), []).append(name)
    text += "".join(f"; {thing}s {does} in {listed(names)}" for (thing, does), names in struck.items())
    text += f"; {missing}" if missing and judged and not open_cases else ""
    amplified = most_amplified(every)
    if amplified is not None:
        case = next(name for name, rows in verdicts.items() if amplified in ((row.subject, row.amplification) for row in rows))
        text += f"; {amplified_text(every)}, in {case}"
    unjudged_count = len({(row.criterion, row.subject) for row in every if row.verdict == NOT_JUDGED and not row.contact})
    text += (
        f"; {several(unjudged_count, 'value')} {'has' if unjudged_count == 1 else 'have'} no limit" if unjudged_count else ""
    )
    values: dict[str, float | str | None] = {"answer": text.partition(":")[0], "cases": float(len(verdicts))}
    if worst is not None:
        values |= {
            "most_critical": worst.subject, "criterion": str(worst.criterion), "utilisation": worst.utilisation, "case": where,
        }  # fmt: skip
    if amplified is not None:
        values |= {"amplified": amplified[0], "amplification": amplified[1].ratio}
    return Statement("headline", f"{text}.", tone=tone, values=values)


def matrix_table(verdicts: Mapping[str, Sequence[Verdict]]) -> Table:
    """Tabulate the utilisation of each kind of limit in each case; the last row names the governing case."""
    kinds = list(dict.fromkeys(row.criterion.kind for rows in verdicts.values() for row in rows if row.utilisation is not None))
    contacts = any(row.contact for rows in verdicts.values() for row in rows)
    rows: list[Row] = []
    largest: dict[str, list[tuple[float, int]]] = {}
    for number, (name, of_case) in enumerate(verdicts.items(), start=1):
        cells: list[Cell] = [str(number), name]
        for kind in kinds:
            used = [row.utilisation for row in of_case if row.criterion.kind == kind and row.utilisation is not None]
            cells.append(used_mark(max(used, default=None)))
            largest.setdefault(kind, []).extend((value, number) for value in used)
        touched = [row.contact for row in of_case if row.contact]
        answer = headline(of_case)
        cells += [f"{touched.count(STRUCK)} of {len(touched)}"] if contacts else []
        rows.append([*cells, Mark(answer.text.partition(":")[0], answer.tone)])
    if len(verdicts) > 1:
        governs = []
        for kind in kinds:
            worst = max(value for value, _ in largest[kind])
            cases = {number for value, number in largest[kind] if value == worst}
            governs.append("all" if len(cases) == len(verdicts) else f"case {min(cases)}")
        rows.append(["", "governed by", *governs, *([""] if contacts else []), ""])
    columns = [Column(align="left"), Column("load case", align="text")]
    columns += [Column(kind.replace(" ", "\n", 1), "%", "z.0f") for kind in kinds]
    columns += left("stops,\ncontacts struck") if contacts else []
    return Table(
        "matrix", "What each load case uses of the limits", [*columns, *left("verdict")],
        rows,
        note="Used: value over limit, of all bodies, points and mounts the largest; above 100 % where it is exceeded.",
    )  # fmt: skip


def governing_table(verdicts: Mapping[str, Sequence[Verdict]]) -> Table | None:
    """Tabulate every limit with the case that uses most of it; None if no limit is judged."""
    by_limit: dict[tuple[str, str], list[tuple[str, Verdict]]] = {}
    for name, of_case in verdicts.items():
        for row in of_case:
            if row.utilisation is not None:
                by_limit.setdefault((row.criterion.kind, row.subject), []).append((name, row))
    rows: list[tuple[tuple[bool, bool, float], Row]] = []
    for of_all in by_limit.values():
        name, worst = max(of_all, key=lambda pair: pair[1].utilisation or 0.0)
        cases = {case for case, row in of_all if row.value == worst.value}
        used = worst.utilisation or 0.0
        cells: list[Cell] = [
            str(worst.criterion), worst.subject, shown(worst.limit, worst.unit), shown(worst.value, worst.unit),
            shown_unit(worst.unit), used_mark(used), "all" if len(cases) == len(verdicts) > 1 else name, worst.time,
            Mark(worst.verdict, TONE[worst.verdict]),
        ]  # fmt: skip
        rows.append(((used <= 1.0, worst.criterion.kind not in _PAYLOAD_LIMITS, -used), cells))
    if not rows:
        return None
    rows.sort(key=lambda pair: pair[0])
    over = sum(not within for (within, *_), _ in rows)
    return Table(
        "governing",
        "Every limit and the load case that governs it",
        (
            *left("limit of", "where"), Column("limit"), Column("reached"),
            *left("unit"), Column("used", "%", "z.0f"), *left("governed by"),
            Column("at", "s", "z.4f"), *left("verdict"),
        ),
        [cells for _, cells in rows],
        note="Of a limit with several directions or senses the one that is used most. Exceeded limits stand first, then those "
        "of the payload, then those of the mounts.",
        shown=max(over, _SHOWN_LIMITS),
    )  # fmt: skip


def _cases(job: JudgedJob) -> Iterator[Table]:
    """Yield the table of load cases: what acts, for how long, from which state, and where it is stated."""
    rows: list[Row] = []
    for case in job.cases:
        simulate = case.run.inputs.get("simulate", {})
        initial = str(simulate.get("initial", "settled"))
        rows.append([case.name, case.run.acting, simulate.get("duration"), START.get(initial, initial), case.note])
    columns = [
        *left("load case"), Column("what acts", align="text"), Column("simulated", "s", 3), Column("begins", align="text"),
        Column("from", align="text"),
    ]  # fmt: skip
    if not any(case.note for case in job.cases):
        columns, rows = columns[:-1], [row[:-1] for row in rows]
    yield Table("load-cases", "Load cases", columns, rows)


def _run_blocks(case: JudgedCase, sections: Collection[str]) -> Iterator[Block]:
    """Yield the blocks of a case's run in `sections`, with ids below the case's folder."""
    for section in run_content(case.run).sections:
        for block in section.blocks if section.id in sections else ():
            yield replace(block, id=f"{case.folder}/{block.id}") if block.id else block


def basis_blocks(
    runs: Mapping[str, JudgedRun], assumptions: Sequence[str], validation: Sequence[str]
) -> Iterator[Block | None]:
    """Yield what is assumed, what was checked, and what was not validated, with the author's paragraphs."""
    devices = list({device.name: device for run in runs.values() for device in devices_of(run)}.values())
    first, numerics = next(iter(runs.values())), {case: run.response.numerics for case, run in runs.items()}

    starts: dict[str, list[str]] = {}
    for case, run in runs.items():
        initial = str(run.inputs.get("simulate", {}).get("initial", "settled"))
        starts.setdefault(START.get(initial, initial), []).append(case)
    beginnings = {
        text: "Every load case begins" if len(starts) == 1 else f"{listed(of)}: begins" for text, of in starts.items()
    }
    assumed = [f"{begin} {text}." for text, begin in beginnings.items()]
    assumed.append(f"Gravity is {first.gravity:g} m/s²." if first.gravity else "There is no gravity.")
    assumed.append("The base moves as the load case says, whatever the mounts do to it; bodies are those of the model.")
    for device in devices:
        if count := len(device.provenance.assumed):
            text = f"{several(count, 'assumption')} about its figures, listed with the model and its mounts."
            assumed.append(f"{device.name}: {text}")
    if any(row.criterion == COMBINED and row.utilisation is not None for run in runs.values() for row in run.verdicts):
        assumed.append(OWN_RULE.partition(";")[0] + ".")
    yield Statement("assumed", "Assumed:", items=tuple(assumed))
    yield from stated("assumptions", assumptions, STATED)

    checked = []
    errors = {case: of_case.error_estimate for case, of_case in numerics.items() if math.isfinite(of_case.error_estimate)}
    if errors:
        worst = max(errors, key=errors.__getitem__)
        text = f"at most {with_unit(errors[worst], '%', digits=2)} of the peaks ({worst})."
        checked.append(f"Numerical error, by halving the step before each run: {text}")
    steps = with_unit(max(of_case.timestep for of_case in numerics.values()), "ms", digits=3)
    engines = listed(sorted({of_case.computed_by for of_case in numerics.values()}))
    checked.append(f"Computed by {engines} in Runge-Kutta steps of at most {steps}.")
    inputs = str(first.inputs.get("options", {}).get("inputs", ""))
    if inputs.startswith("model "):
        digest = inputs.partition(",")[0].removeprefix("model ")
        checked.append(f"Model and isolators have the digest {digest}; every case can be replayed from its folder.")
    for device in devices:
        source = f" of {device.provenance.source.rstrip('.')}" if device.provenance.source else ""
        fitted = f", fitted to {device.provenance.fitted_to.rstrip('.')}" if device.provenance.fitted_to else ""
        checked.append(f"{device.name}: {device.provenance.kind} figures{source}{fitted}.")
    yield Statement("validated", "Checked, and fitted to data:", items=tuple(checked))
    yield from stated("validation", validation, STATED)

    unknown = [case for case in runs if case not in errors]
    missing = [f"No numerical error was estimated in {listed(unknown)}."] if unknown else []
    missing += [f"{case}: {run.untested}" for case, run in runs.items() if run.untested]
    for kind in ("estimated", "illustrative"):
        if names := [device.name for device in devices if device.provenance.kind == kind]:
            missing.append(f"{listed(names)}: the figures are {kind}, not measured.")
    missing.append("Results were not compared with a measurement of this installation by this program.")
    yield Statement("not-validated", "Not validated:", items=tuple(missing), tone="unjudged")


def stated(name: str, paragraphs: Sequence[str], before: str = "") -> Iterator[Statement]:
    """Yield the author's paragraphs as statements, each with the text `before` in front."""
    for number, text in enumerate(paragraphs, start=1):
        yield Statement(f"{name}-{number}", f"{before}{text}")
