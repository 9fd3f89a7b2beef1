"""What the results of a job rest on: what is assumed, and what was validated and by what."""

import math
from collections.abc import Iterator, Mapping, Sequence

from wirerope_mj.assessment.criteria import COMBINED
from wirerope_mj.assessment.criteria.summary import OWN_RULE
from wirerope_mj.content.blocks import Block, Statement
from wirerope_mj.content.judged_run import JudgedRun
from wirerope_mj.content.model import devices_of
from wirerope_mj.content.numbers import listed, several, with_unit
from wirerope_mj.content.run import START
from wirerope_mj.mounts.isolator import Isolator

STATED = "Stated by the author: "  # stands before what no computation says


def basis_blocks(
    runs: Mapping[str, JudgedRun], assumptions: Sequence[str], validation: Sequence[str]
) -> Iterator[Block | None]:
    """Yield what is assumed and what was validated, the author's own paragraphs after what the runs say."""
    devices = list({one.name: one for run in runs.values() for one in devices_of(run)}.values())
    yield Statement(id="assumed", text="Assumed:", items=tuple(_assumed(runs, devices)))
    yield from stated("assumptions", assumptions, STATED)
    yield Statement(id="validated", text="Validated:", items=tuple(_validated(runs, devices)))
    yield from stated("validation", validation, STATED)
    yield Statement(
        id="not-validated", text="Not validated:", items=tuple(_not_validated(runs, devices)), tone="unjudged"
    )


def stated(name: str, paragraphs: Sequence[str], before: str = "") -> Iterator[Statement]:
    """Yield what a document's author states."""
    for number, text in enumerate(paragraphs, start=1):
        yield Statement(id=f"{name}-{number}", text=f"{before}{text}")


def _assumed(runs: Mapping[str, JudgedRun], devices: Sequence[Isolator]) -> Iterator[str]:
    starts: dict[str, list[str]] = {}
    for case, run in runs.items():
        initial = str(run.inputs.get("simulate", {}).get("initial", "settled"))
        starts.setdefault(START.get(initial, initial), []).append(case)
    for text, cases in starts.items():
        yield f"{'Every load case begins' if len(starts) == 1 else f'{listed(cases)}: begins'} {text}."
    first = next(iter(runs.values()))
    yield f"Gravity is {first.gravity:g} m/s²." if first.gravity else "There is no gravity."
    yield "The base moves as the load case says, whatever the mounts do to it; bodies are those of the model."
    for device in devices:
        if assumed := len(device.provenance.assumed):
            yield f"{device.name}: {several(assumed, 'assumption')} about its figures, listed with the model and its mounts."
    if any(row.criterion == COMBINED and row.utilisation is not None for run in runs.values() for row in run.verdicts):
        yield OWN_RULE.partition(";")[0] + "."


def _validated(runs: Mapping[str, JudgedRun], devices: Sequence[Isolator]) -> Iterator[str]:
    errors = {case: run.response.numerics.error_estimate for case, run in runs.items()}
    known = {case: error for case, error in errors.items() if math.isfinite(error)}
    if known:
        worst = max(known, key=lambda case: known[case])
        yield (
            f"Numerical error, by halving the step before each run: at most {with_unit(known[worst], '%', digits=2)} of the "
            f"peaks ({worst})."
        )
    for device in devices:
        stated = device.provenance
        fitted = f", fitted to {stated.fitted_to.rstrip('.')}" if stated.fitted_to else ""
        source = f" of {stated.source.rstrip('.')}" if stated.source else ""
        yield f"{device.name}: {stated.kind} figures{source}{fitted}."


def _not_validated(runs: Mapping[str, JudgedRun], devices: Sequence[Isolator]) -> Iterator[str]:
    unknown = [case for case, run in runs.items() if not math.isfinite(run.response.numerics.error_estimate)]
    if unknown:
        yield f"No numerical error was estimated in {listed(unknown)}."
    for case, run in runs.items():
        if run.untested:
            yield f"{case}: {run.untested}"
    for kind in ("estimated", "illustrative"):
        if names := [device.name for device in devices if device.provenance.kind == kind]:
            yield f"{listed(names)}: the figures are {kind}, not measured."
    yield "Results were not compared with a measurement of this installation by this program."
