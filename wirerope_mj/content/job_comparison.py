"""Content of a comparison of two jobs: utilisation of limits in every load case, and inputs that differ."""

from collections.abc import Iterator, Mapping, Sequence

from wirerope_mj.assessment.criteria import EXCEEDED, Verdict
from wirerope_mj.assessment.criteria.verdict import most_used
from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.job import JudgedJob, job_headline
from wirerope_mj.content.numbers import listed, several, with_unit
from wirerope_mj.content.verdicts import headline, used_mark
from wirerope_mj.foundation.tables import Cell, Column, Mark, Row, Table, left
from wirerope_mj.motions.registry import SPOKEN_MOTIONS

# Names and values of what was given to each load case of each job
Inputs = Mapping[str, Mapping[str, Mapping[str, str]]]

_NEGLIGIBLE_CHANGE = 0.005  # of a utilisation, below which two are shown as the same percentage
_SHOWN_LIMITS = 12
_DERIVED = ("inputs", "timestep", "engine")  # inputs that follow from others: digests, and choices made for a run
_MOTION_OPTIONS = {*SPOKEN_MOTIONS, "levels", "record"}  # options that describe the motion


def job_comparison_content(jobs: Mapping[str, JudgedJob], inputs: Inputs, models: Inputs) -> Content:
    """Compose the content of a comparison of two jobs; `inputs` and facts of the `models` by job and load case."""
    first, second = jobs.values()
    names = list(jobs)

    def headlines() -> Iterator[Block]:
        for number, (name, job) in enumerate(jobs.items(), start=1):
            answer = job_headline(job.verdicts)
            yield Statement(f"headline-{number}", f"{name}: {answer.text}", tone=answer.tone, values=answer.values)

    common = [case for case in first.verdicts if case in second.verdicts]
    change = {case: _largest_use(second.verdicts[case]) - _largest_use(first.verdicts[case]) for case in common}
    more = [case for case, by in change.items() if by >= _NEGLIGIBLE_CHANGE]
    less = [case for case, by in change.items() if by <= -_NEGLIGIBLE_CHANGE]
    newly_exceeded = [case for case in common if _fails(second, case) and not _fails(first, case)]
    newly_kept = [case for case in common if _fails(first, case) and not _fails(second, case)]
    parts = [
        f"{names[1]} exceeds limits in {listed(newly_exceeded)}, which {names[0]} keeps" if newly_exceeded else "",
        f"{names[1]} keeps the limits in {listed(newly_kept)}, which {names[0]} exceeds" if newly_kept else "",
        f"uses more of the limits in {listed(more)}" if more else "",
        f"uses less of the limits in {listed(less)}" if less else "",
    ]
    text = "; ".join(filter(None, parts)) or f"{names[1]} uses as much of the limits as {names[0]} in all common load cases"
    text = text if text.startswith(names[1]) else f"{names[1]} {text}"
    return Content(
        title=" and ".join(names),
        verdict=Statement("headline", f"{text}.", tone="exceeded" if newly_exceeded else ""),
        sections=(
            Section("headlines", "", headlines, "headline"),
            Section("cases", "Load cases", lambda: [_cases(names, first, second)], "summary"),
            Section("limits", "Limits", lambda: [_limits(names, first, second)], "summary"),
            Section("inputs", "Inputs", lambda: [_inputs(names, first, second, inputs, models)], "summary"),
        ),
    )


def _largest_use(verdicts: Sequence[Verdict]) -> float:
    """Find the largest utilisation of any limit; 0 if none is judged."""
    worst = most_used(verdicts)
    return worst.utilisation or 0.0 if worst is not None else 0.0


def _fails(job: JudgedJob, case: str) -> bool:
    return any(row.verdict == EXCEEDED for row in job.verdicts[case])


def _cases(names: Sequence[str], first: JudgedJob, second: JudgedJob) -> Table:
    """Tabulate verdict and most critical limit of every load case in both jobs."""
    rows: list[Row] = []
    for case in dict.fromkeys((*first.verdicts, *second.verdicts)):
        cells: list[Cell] = [case]
        for job in (first, second):
            verdicts = job.verdicts.get(case)
            if verdicts is None:
                cells += ["not in it", None, ""]
                continue
            answer, worst = headline(verdicts), most_used(verdicts)
            cells.append(Mark(answer.text.partition(":")[0], answer.tone))
            cells += [used_mark(worst.utilisation if worst else None), f"{worst.criterion}, {worst.subject}" if worst else ""]
        rows.append(cells)
    columns = left("load case")
    for name in names:
        columns += [Column(name, align="left"), Column("used", "%", "z.0f"), Column("in", align="text")]
    return Table("cases", "The most critical limit of each load case", columns, rows)


def _limits(names: Sequence[str], first: JudgedJob, second: JudgedJob) -> Table | Statement:
    """Tabulate limits of which the jobs use different fractions, each with its governing load cases."""
    largest: list[dict[tuple[str, str], tuple[float, str]]] = []
    for job in (first, second):
        of_job: dict[tuple[str, str], tuple[float, str]] = {}
        for case, verdicts in job.verdicts.items():
            for row in verdicts:
                key = str(row.criterion), row.subject
                if row.utilisation is not None and row.utilisation > of_job.get(key, (-1.0, ""))[0]:
                    of_job[key] = row.utilisation, case
        largest.append(of_job)
    rows: list[tuple[float, Row]] = []
    for key in dict.fromkeys((*largest[0], *largest[1])):
        (before, first_case), (after, second_case) = (of_job.get(key, (None, "")) for of_job in largest)
        if before is None or after is None or abs(after - before) >= _NEGLIGIBLE_CHANGE:
            change = None if before is None or after is None else after - before
            cells = [*key, used_mark(before), first_case, used_mark(after), second_case, change]
            rows.append((-max(before or 0.0, after or 0.0), cells))
    if not rows:
        return Statement("limits", "They use the same fraction of every limit.")
    rows.sort(key=lambda pair: pair[0])
    columns = left("limit of", "where")
    for name in names:
        columns += [Column(name, "%", "z.0f"), *left("in")]
    return Table(
        "limits", f"{several(len(rows), 'limit')} of which they use different fractions",
        [*columns, Column("change", "%", "+.0f")], [cells for _, cells in rows], shown=_SHOWN_LIMITS,
    )  # fmt: skip


def _inputs(names: Sequence[str], first: JudgedJob, second: JudgedJob, inputs: Inputs, models: Inputs) -> Statement:
    """List the inputs and limits of common load cases that differ, each difference once with its cases."""
    differences: dict[str, list[str]] = {}
    common = [case for case in first.verdicts if case in second.verdicts]
    for case in common:
        before, after = (models[name].get(case, {}) for name in names)
        of_model = _different(before, after)
        # laws of one isolator in place of another are that isolator's
        shared = {*before.values()} & {*after.values()}
        told = [key for key in of_model if ": " not in key or key.partition(": ")[0] in shared]
        alike: dict[str, list[str]] = {}  # mounts with the same change are said together
        for key in told:
            alike.setdefault(f"{before.get(key, 'none')} -> {after.get(key, 'none')}", []).append(key)
        texts = [f"{listed(keys, most=_SHOWN_LIMITS)}: {change}" for change, keys in alike.items()]
        before, after = (inputs[name].get(case, {}) for name in names)
        differ = _different(before, after)
        for key in differ:
            if key.startswith("model/"):
                texts += [] if told else [f"{key}: its text differs, in nothing that moves or bears"]
            elif key not in _DERIVED and not (key == "motion" and _MOTION_OPTIONS & set(differ)):
                texts.append(f"{key}: {before.get(key, 'not given')} -> {after.get(key, 'not given')}")
        before, after = (
            {f"limit of {row.criterion} of {row.subject}": with_unit(row.limit, row.unit) for row in rows if row.limit}
            for rows in (first.verdicts[case], second.verdicts[case])
        )
        texts += [f"{key}: {before.get(key, 'none')} -> {after.get(key, 'none')}" for key in _different(before, after)]
        for text in texts:
            differences.setdefault(text, []).append(case)
    cases = {text: "every case" if len(of) == len(common) > 1 else listed(of) for text, of in differences.items()}
    items = tuple(f"{where}: {text}" for text, where in cases.items())
    return Statement("inputs", "Inputs that differ:" if items else "No input of a common load case differs.", items=items)


def _different(before: Mapping[str, str], after: Mapping[str, str]) -> list[str]:
    """List the keys under which the texts differ, or only one has a text."""
    return [key for key in dict.fromkeys((*before, *after)) if before.get(key) != after.get(key)]
