"""What a calibration says, whoever shows it: the values that the tests tell, what they do not, and how the model follows."""

import math
from collections.abc import Iterator, Sequence
from importlib.metadata import version

import numpy as np

from wirerope_mj.content.blocks import Block, Content, Section, Statement
from wirerope_mj.content.identification import record_warnings
from wirerope_mj.content.numbers import number, several, with_unit
from wirerope_mj.content.panels import Chart, Curve, Panel, short
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table
from wirerope_mj.foundation.units import duration_text, in_unit, shown_in
from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.studies.calibration.calibrate import DISCREPANT, LEVEL, LITTLE, Calibration
from wirerope_mj.studies.calibration.predict import Prediction
from wirerope_mj.studies.results.stated_limits import StatedLimit

_ACROSS = {"time": "time [s]", "logarithm of frequency": "frequency [Hz]", "loop": "along the loop", "other": ""}

_DRAWN = 8  # channels that are drawn, those that the model follows least first
_NORMAL = 1.645  # standard deviations about the middle of a normal distribution that hold 90 % of it
_BEYOND = {
    True: "The band holds what laws may do there that follow the tests alike, hardening free",
    False: "The band holds no other hardening than that of the laws: those that follow the tests as well fall there",
}
_BEST = 1e-3  # probability below which less is said than "less than 0.1 %": as many draws as there are do not tell


def calibration_content(
    result: Calibration, *, title: str, sources: Sequence[str], warnings: Sequence[str] = (),
    predictions: Sequence[tuple[Prediction, Sequence[StatedLimit]]] = (),
) -> Content:  # fmt: skip
    """Compose what a calibration says: values, how the model follows, and predictions of other motions against their limits."""
    return Content(
        title=title,
        facts=(("Tests", several(len(result.forward.tests), "test")), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Which values of the model follow the measured tests, and how well are they known?",),
        verdict=_headline(result),
        sections=(
            Section("values", "Values", lambda: (_values_table(result),), "summary"),
            Section("answer", "", lambda: (_findings(result), record_warnings(warnings)), "headline"),
            Section(
                "prediction", "Prediction", lambda: [block for one in predictions for block in _prediction_blocks(*one)],
                "summary",
            ),
            Section("channels", "How the model follows", lambda: (_channel_table(result),), "summary"),
            Section("histories", "Measured and calculated", lambda: _charts(result)),
            Section("known-together", "Known together", lambda: (_correlation_table(result),) if len(result.names) > 1 else ()),
            Section("read-from", "Read from", lambda: (Statement(id="sources", items=tuple(sources)),)),
        ),
    )  # fmt: skip


def _headline(result: Calibration) -> Statement:
    """Return the conclusion: the first value, or the worst of convergence, model error and what is not known."""
    error = float(result.discrepancies.max())
    values = {"model_error": error, "emulator_error": result.posterior.emulator_error}
    if not result.fit.converged:
        return Statement(id="headline", text=f"NOT CONVERGED: {result.message}.", tone="exceeded", values=values)
    known = ", ".join(_value_text(result, k) for k, name in enumerate(result.names) if not name.startswith("channel/"))
    doubts = []
    if error > DISCREPANT:
        doubts.append(f"the model does not follow the tests: its own error is {100.0 * error:.2g} % of the response")
    doubts += [f"{name} is at the {end} end of its prior" for name, end in result.at_an_end.items()]
    doubts += ["the tests do not tell everything"] if result.not_identified else []
    text = f"{known}; {'; '.join(doubts)}." if doubts else f"{known}."
    return Statement(id="headline", text=text, tone="unjudged" if doubts else "within", values=values)


def _value_text(result: Calibration, k: int) -> str:
    low, high = result.intervals()[k]
    unit = _unit(result, k)
    digits = _digits(result.values[k], 0.5 * (high - low))
    ends = f"{number(low, digits=digits)} to {number(high, digits=digits)}"
    return f"{result.names[k]} {number(result.values[k], digits=digits)} ({ends}) {unit}".rstrip()


def _unit(result: Calibration, k: int) -> str:
    """Return the unit of a value, that of its law's parameter or of its channels where it has no one name; "" of a factor."""
    name, unit = result.names[k], result.units[k]
    if unit != "SI":
        return unit
    if not name.startswith("channel/"):
        parameter = name.rpartition("/")[2].rpartition(".")[2].partition("[")[0]
        of_laws = {law.units[parameter] for law in LAWS.values() if parameter in law.units}
        return of_laws.pop() if len(of_laws) == 1 else unit  # laws use some names in several senses
    units = {one.unit for one in result.problem.series}
    return units.pop() if len(units) == 1 else unit


def _digits(value: float, half: float) -> int:
    """Return the significant digits that a value has with an error."""
    return int(np.clip(2 + math.ceil(math.log10(abs(value) / half)), 2, 6)) if value and half > 0.0 else 3


def _values_table(result: Calibration) -> Table:
    """Tabulate medians, intervals, and what was learned of each value."""
    rows: list[list[Cell]] = []
    for k, name in enumerate(result.names):
        low, high = result.intervals()[k]
        decimals = 3 - math.floor(math.log10(high - low)) if high > low else 12
        value, low, high = (round(float(one), decimals) for one in (result.values[k], low, high))
        left = float(result.learned[k])
        note: Cell = ""
        if end := result.at_an_end.get(name):
            note = Mark(f"at the {end} end of its prior", "unjudged")
        elif left > LITTLE:
            note = Mark("the tests say little of it", "unjudged")
        elif name in result.insignificant:
            note = Mark("not significant; consider dropping it", "unjudged")
        rows.append([name, value, low, high, _unit(result, k) or "factor", left, note])
    percent = f"{100.0 * LEVEL:.0f} %"
    return Table(
        id="values", title=f"Values, and the interval that holds each with a probability of {percent}",
        columns=(
            Column("quantity", align="left"), Column("median", form="z.5g"), Column("from", form="z.5g"),
            Column("to", form="z.5g"), Column("unit", align="left"), Column("left of the prior", "%", ".2g"),
            Column("note", align="left"),
        ),
        rows=rows, note="Left of the prior: standard deviation after the tests over that stated before.",
    )  # fmt: skip


def _findings(result: Calibration) -> Statement:
    texts = [result.message]
    texts += [
        f"{name} ends at the {end} end of what was stated of it before, and may lie beyond: state a wider prior"
        for name, end in result.at_an_end.items()
    ]
    texts += result.not_identified or (() if result.at_an_end else ("the tests tell every value",))
    texts += [f"{name} is not significant; consider dropping it" for name in result.insignificant]
    worst = int(np.argmax(result.discrepancies))
    if (error := float(result.discrepancies[worst])) > DISCREPANT:
        name = result.problem.series[worst].name
        remedy = "the intervals count it, but say nothing of what the model lacks: try another law, or what else may differ"
        if lag := result.lag(worst):
            way = "later" if lag > 0.0 else "earlier"
            remedy = (
                f"it is {duration_text(abs(lag), 2)} {way} than the model: they may be on two clocks; say when its first "
                "sample was taken, start (--start), or vary channel/*/delay"
            )
        error_text = f"what is left there is {100.0 * error:.2g} % of the response and no noise"
        texts.append(f"the model does not follow {name}: {error_text}; {remedy}")
    return Statement(id="findings", items=tuple(texts))


def _channel_table(result: Calibration) -> Table:
    """Tabulate for each channel what the fit leaves: error, noise, and the model's own error."""
    rows: list[list[Cell]] = []
    model = result.problem.split(result.fit.model)
    for one, noise, own in zip(result.problem.series, result.fit.noises, model, strict=True):
        in_time = one.across == "time"
        error = float(np.sqrt(np.mean((own - one.values) ** 2))) / one.rms
        peak = float(np.abs(own).max() / np.abs(one.values).max()) if in_time else None
        of_sample = noise.white / one.averaged
        white = with_unit(of_sample, one.unit, digits=2) if one.unit else f"{100.0 * of_sample:.2g} %"
        length = noise.length if in_time else None
        rows.append([one.name, peak, error, white, noise.discrepancy, length, one.frequency or None])
    return Table(
        id="channels",
        title="Channels: calculated over measured peak, what is left, and its parts",
        columns=(
            Column("channel", align="left"), Column("peak ratio", form=".3f"), Column("left (rms)", "%", ".2g"),
            Column("noise", align="left"), Column("model error", "%", ".2g"), Column("correlated over", "ms", ".3g"),
            Column("about", "Hz", ".3g"),
        ),
        rows=rows,
        note="Noise: of a measured sample (standard deviation), of which those that are compared average several. Model error: "
        "of the response where it is largest. Peaks are those of the smoothed samples that are compared.",
    )  # fmt: skip


def _charts(result: Calibration) -> Iterator[Chart]:
    """Yield measured and calculated histories with their bands, the worst channels first."""
    draws = [result.problem.split(one) for one in result.posterior.series]
    middle = result.problem.split(np.median(result.posterior.series, axis=0))
    for k in np.argsort(-result.discrepancies)[:_DRAWN].tolist():
        one, noise = result.problem.series[k], result.fit.noises[k]
        unit = shown_in(one.unit)[0]
        spread = np.std([own[k] for own in draws], axis=0)
        half = _NORMAL * np.sqrt(spread**2 + noise.deviation(one) ** 2)
        y = [in_unit(values, unit) for values in (one.values, middle[k], middle[k] - half, middle[k] + half)]
        x, what = one.at, _ACROSS[one.across]
        ylabel, log = f"{one.name.split('/')[-2]} [{unit}]" if unit else "", ""
        if one.across == "logarithm of frequency":
            x, y, ylabel, log = np.exp(x), [np.exp(values) for values in y], "transmissibility", "xy"
        panel = Panel(
            curves=(
                Curve(x=x, y=y[1], name="calculated", kind=0, dash="dashed"),
                Curve(x=x, y=y[0], name="measured", kind=1, marks=one.across != "time", weight=2.0),
                Curve(x=x, y=y[2], name="90 % band", kind=0, dash="dotted"),
                Curve(x=x, y=y[3], name="", kind=0, dash="dotted"),
            ),
            ylabel=ylabel, xlabel=what, unit=unit, log=log,
        )  # fmt: skip
        steps = np.diff(one.at)
        gaps = one.across == "time" and bool((steps > 1.5 * np.median(steps)).any())
        yield Chart(
            rows=((panel,),), height=170.0, id=f"history-{k}",
            caption=f"{one.name}: measured and calculated with the medians; the band holds what the values and the model's own "
            f"error leave open.{' Saturated samples are left out, and both curves straight there.' if gaps else ''}",
            alt=f"{one.name}, measured and calculated",
        )  # fmt: skip


def _correlation_table(result: Calibration) -> Table:
    columns = [Column("quantity", align="left"), *(Column(short(name), form="+z.2f") for name in result.names)]
    rows: list[list[Cell]] = [[name, *row.tolist()] for name, row in zip(result.names, result.correlation, strict=True)]
    return Table(id="correlations", title="Correlations of the draws", columns=columns, rows=rows)


def _prediction_blocks(prediction: Prediction, limits: Sequence[StatedLimit]) -> Iterator[Block]:
    """Yield the verdicts on limits, and the bands of a prediction's main measures."""
    items, worst, beyond = [], 0.0, prediction.farthest.beyond
    for limit in limits:
        for name in limit.measures:
            chance, value = prediction.exceedance(name, limit.limit), limit.text.partition("=")[2].strip()
            if math.isnan(chance):
                items.append(f"{name}: {value} is not judged, since it is not predicted")
                continue
            worst = max(worst, chance)
            said = "less than 0.1 %" if chance < _BEST else f"{100.0 * chance:.{3 if chance > 0.99 else 2}g} %"
            said = "more than 99.9 %" if chance > 1.0 - _BEST else said
            items.append(f"{name}: {value} is exceeded with a probability of {said}{', beyond the tests' if beyond else ''}")
    if items:
        tone = "exceeded" if worst > 0.5 else "near" if worst > 1.0 - LEVEL else "within"
        if tone == "within" and (beyond or prediction.refused):
            tone = "unjudged"
        yield Statement(id="exceedance", text=f"{prediction.motion}:", items=tuple(items), tone=tone)
    if beyond:
        yield Statement(
            id="beyond-tests", tone="unjudged",
            text=f"Prediction {prediction.farthest.text}. {_BEYOND[prediction.hardening]}; test as far as that, or take it "
            "for an estimate.",
        )  # fmt: skip
    if prediction.refused:
        kinds = dict.fromkeys(name.partition("/")[0] for name in prediction.refused if "/" in name)
        yield Statement(
            id="not-predicted", tone="unjudged",
            text=f"Not predicted: {', '.join(kinds)} of what no test measured. The model does not follow the tests, and what "
            "else gives way there, a fixture or another mode, decides them: measure them, or mend the model.",
        )  # fmt: skip
    names = [
        name for name in prediction.names
        if name.partition("/")[0] in ("acceleration", "deflection", "force", "displacement")
        and np.isfinite(prediction.values(name)).all() and prediction.values(name).max() > 0.0
    ]  # fmt: skip
    rows: list[list[Cell]] = []
    for name in names:
        low, high = prediction.band(name)
        unit = {"acceleration": "m/s^2", "force": "N"}.get(name.partition("/")[0], "m")
        rows.append([name, *(with_unit(value, unit) for value in (float(np.median(prediction.values(name))), low, high))])
    yield Table(
        id="prediction",
        title=f"Predicted for {prediction.motion}{', beyond the tests' if beyond else ''}",
        columns=(
            Column("measure", align="left"), Column("median", align="left"), Column("from", align="left"),
            Column("to", align="left"),
        ),
        rows=rows,
        note=f"From and to hold {100.0 * LEVEL:.0f} %; errors of peaks of {100.0 * prediction.peak_error:.2g} % are in them, "
        f"and {'what the tests leave open of how the laws harden' if prediction.hardening else 'no other hardening of laws'}.",
        shown=12,
    )  # fmt: skip
