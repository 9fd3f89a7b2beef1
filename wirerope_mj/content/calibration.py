"""Content of a calibration: identified values with intervals, agreement of the model with the tests, and predictions."""

import math
from collections.abc import Iterator, Sequence
from importlib.metadata import version

import numpy as np

from wirerope_mj.content.blocks import MEASURED, MODEL, Block, Chart, Content, Curve, Panel, Section, Statement, short
from wirerope_mj.content.identification import record_warnings
from wirerope_mj.content.numbers import number, several, with_unit
from wirerope_mj.foundation.tables import Cell, Column, Mark, Table, left
from wirerope_mj.foundation.units import duration_text, in_unit, shown_in
from wirerope_mj.mounts.laws import LAWS
from wirerope_mj.studies.calibration.calibrate import DISCREPANT, LEVEL, LITTLE, Calibration
from wirerope_mj.studies.calibration.predict import Prediction
from wirerope_mj.studies.results.varied import StatedLimit

_AXIS_LABELS = {"time": "time [s]", "logarithm of frequency": "frequency [Hz]", "loop": "along the loop", "other": ""}

_SHOWN_CHANNELS = 8  # channels that are drawn, those of the largest discrepancy first
_NORMAL = 1.645  # standard deviations on both sides that hold 90 % of a normal distribution
_BAND_TEXT = {
    True: "The band holds what laws may do there that follow the tests alike, hardening free",
    False: "The band holds no other hardening than that of the laws: those that follow the tests as well fall there",
}
_RESOLUTION = 1e-3  # probability that the number of draws resolves


def calibration_content(
    result: Calibration, *, title: str, sources: Sequence[str], warnings: Sequence[str] = (),
    predictions: Sequence[tuple[Prediction, Sequence[StatedLimit]]] = (),
) -> Content:  # fmt: skip
    """Compose the content of a calibration: values, agreement in each channel, and predictions against their limits."""
    error = float(result.discrepancies.max())
    if result.fit.converged:
        texts = []
        for k, (name, (low, high)) in enumerate(zip(result.names, result.intervals(), strict=True)):
            if not name.startswith("channel/"):
                value, half = result.values[k], 0.5 * (high - low)
                digits = int(np.clip(2 + math.ceil(math.log10(abs(value) / half)), 2, 6)) if value and half > 0.0 else 3
                shown, lower, upper = (number(value, digits=digits) for value in (value, low, high))
                texts.append(f"{name} {shown} ({lower} to {upper}) {_unit(result, k)}".rstrip())
        doubts = [f"{name} is at the {end} end of its prior" for name, end in result.at_an_end.items()]
        if error > DISCREPANT:
            doubts.insert(0, f"the model does not follow the tests: its own error is {100.0 * error:.2g} % of the response")
        doubts += ["the tests do not tell everything"] if result.not_identified else []
        text, tone = "; ".join(filter(None, [", ".join(texts), *doubts])), "unjudged" if doubts else "within"
    else:
        text, tone = f"NOT CONVERGED: {result.message}", "exceeded"
    values = {"model_error": error, "emulator_error": result.posterior.emulator_error}
    return Content(
        title=title,
        facts=(("Tests", several(len(result.forward.tests), "test")), ("By", f"wirerope-mj {version('wirerope-mj')}")),
        question=("Which values of the model follow the measured tests, and how well are they known?",),
        verdict=Statement("headline", f"{text}.", tone=tone, values=values),
        sections=(
            Section("values", "Values", lambda: (_values_table(result),), "summary"),
            Section("answer", "", lambda: (_findings(result), record_warnings(warnings)), "headline"),
            Section(
                "prediction", "Prediction", lambda: [block for pair in predictions for block in _prediction_blocks(*pair)],
                "summary",
            ),
            Section("channels", "How the model follows", lambda: (_channel_table(result),), "summary"),
            Section("histories", "Measured and calculated", lambda: _charts(result)),
            Section("known-together", "Known together", lambda: _correlations(result) if len(result.names) > 1 else ()),
            Section("read-from", "Read from", lambda: (Statement("sources", items=tuple(sources)),)),
        ),
    )  # fmt: skip


def _unit(result: Calibration, k: int) -> str:
    """Find the unit of the k-th identified value, by its law or channel where the result says but "SI"; "" for a factor."""
    name, unit = result.names[k], result.units[k]
    if unit != "SI":
        return unit
    if not name.startswith("channel/"):
        parameter = name.rpartition("/")[2].rpartition(".")[2].partition("[")[0]
        law_units = {law.units()[parameter] for law in LAWS.values() if parameter in law.units()}
        return law_units.pop() if len(law_units) == 1 else unit  # laws use some names in several senses
    units = {series.unit for series in result.problem.series}
    return units.pop() if len(units) == 1 else unit


def _values_table(result: Calibration) -> Table:
    """Tabulate each value's median and interval, and how much of its prior's standard deviation is left."""
    rows: list[list[Cell]] = []
    for k, name in enumerate(result.names):
        low, high = result.intervals()[k]
        decimals = 3 - math.floor(math.log10(high - low)) if high > low else 12
        value, low, high = (round(float(value), decimals) for value in (result.values[k], low, high))
        deviation_ratio = float(result.learned[k])
        note = ""
        if end := result.at_an_end.get(name):
            note = f"at the {end} end of its prior"
        elif deviation_ratio > LITTLE:
            note = "the tests say little of it"
        elif name in result.insignificant:
            note = "not significant; consider dropping it"
        rows.append(
            [name, value, low, high, _unit(result, k) or "factor", deviation_ratio, Mark(note, "unjudged") if note else ""]
        )
    percent = f"{100.0 * LEVEL:.0f} %"
    return Table(
        "values", f"Values, and the interval that holds each with a probability of {percent}",
        (
            *left("quantity"), Column("median", form="z.5g"), Column("from", form="z.5g"),
            Column("to", form="z.5g"), *left("unit"), Column("left of the prior", "%", ".2g"),
            *left("note"),
        ),
        rows, note="Left of the prior: standard deviation after the tests over that stated before.",
    )  # fmt: skip


def _findings(result: Calibration) -> Statement:
    """List values at an end of their prior, not identified or not significant, and the channel that the model follows worst."""
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
    return Statement("findings", items=tuple(texts))


def _channel_table(result: Calibration) -> Table:
    """Tabulate for each channel the peak ratio, residual, noise, and the model's error with its correlation length."""
    rows: list[list[Cell]] = []
    model = result.problem.split(result.fit.model)
    for series, noise, calculated in zip(result.problem.series, result.fit.noises, model, strict=True):
        in_time = series.across == "time"
        error = float(np.sqrt(np.mean((calculated - series.values) ** 2))) / series.rms
        peak = float(np.abs(calculated).max() / np.abs(series.values).max()) if in_time else None
        sample_noise = noise.white / series.averaged
        white = with_unit(sample_noise, series.unit, digits=2) if series.unit else f"{100.0 * sample_noise:.2g} %"
        length = noise.length if in_time else None
        rows.append([series.name, peak, error, white, noise.discrepancy, length, series.frequency or None])
    columns = (
        *left("channel"), Column("peak ratio", form=".3f"), Column("left (rms)", "%", ".2g"), *left("noise"),
        Column("model error", "%", ".2g"), Column("correlated over", "ms", ".3g"), Column("about", "Hz", ".3g"),
    )  # fmt: skip
    return Table(
        "channels", "Channels: calculated over measured peak, what is left, and its parts", columns, rows,
        note="Noise: of a measured sample (standard deviation), of which those that are compared average several. Model error: "
        "of the response where it is largest. Peaks are those of the smoothed samples that are compared.",
    )  # fmt: skip


def _charts(result: Calibration) -> Iterator[Chart]:
    """Yield measured and calculated histories with the 90 % band, of the channels of largest discrepancy."""
    draws = [result.problem.split(series) for series in result.posterior.series]
    medians = result.problem.split(np.median(result.posterior.series, axis=0))
    for k in np.argsort(-result.discrepancies)[:_SHOWN_CHANNELS].tolist():
        series, noise = result.problem.series[k], result.fit.noises[k]
        unit = shown_in(series.unit)[0]
        spread = np.std([draw[k] for draw in draws], axis=0)
        half = _NORMAL * np.sqrt(spread**2 + noise.deviation(series) ** 2)
        y = [in_unit(values, unit) for values in (series.values, medians[k], medians[k] - half, medians[k] + half)]
        x, xlabel = series.at, _AXIS_LABELS[series.across]
        ylabel, log = f"{series.name.split('/')[-2]} [{unit}]" if unit else "", ""
        if series.across == "logarithm of frequency":
            x, y, ylabel, log = np.exp(x), [np.exp(values) for values in y], "transmissibility", "xy"
        panel = Panel(
            (
                Curve(x, y[1], name="calculated", kind=MODEL, dash="dashed"),
                Curve(x, y[0], name="measured", kind=MEASURED, marks=series.across != "time", weight=2.0),
                Curve(x, y[2], name="90 % band", kind=MODEL, dash="dotted"),
                Curve(x, y[3], name="", kind=MODEL, dash="dotted"),
            ),
            ylabel, xlabel=xlabel, unit=unit, log=log,
        )  # fmt: skip
        steps = np.diff(series.at)
        gaps = series.across == "time" and bool((steps > 1.5 * np.median(steps)).any())
        yield Chart(
            rows=((panel,),), height=170.0, id=f"history-{k}",
            caption=f"{series.name}: measured and calculated with the medians; the band holds what the values and the "
            f"model's own error leave open.{' Saturated samples are left out: straight lines.' if gaps else ''}",
            alt=f"{series.name}, measured and calculated",
        )  # fmt: skip


def _correlations(result: Calibration) -> Iterator[Table]:
    columns = [*left("quantity"), *(Column(short(name), form="+z.2f") for name in result.names)]
    rows: list[list[Cell]] = [[name, *row.tolist()] for name, row in zip(result.names, result.correlation, strict=True)]
    yield Table("correlations", "Correlations of the draws", columns, rows)


def _prediction_blocks(prediction: Prediction, limits: Sequence[StatedLimit]) -> Iterator[Block]:
    """Yield probabilities of exceeding the limits, cautions, and predicted measures with their bands."""
    items, worst, beyond = [], 0.0, prediction.farthest.beyond
    for limit in limits:
        for name in limit.measures:
            probability, value = prediction.exceedance(name, limit.limit), limit.text.partition("=")[2].strip()
            if math.isnan(probability):
                items.append(f"{name}: {value} is not judged, since it is not predicted")
                continue
            worst = max(worst, probability)
            text = f"{100.0 * probability:.{3 if probability > 0.99 else 2}g} %"
            text = "less than 0.1 %" if probability < _RESOLUTION else text
            text = "more than 99.9 %" if probability > 1.0 - _RESOLUTION else text
            items.append(f"{name}: {value} is exceeded with a probability of {text}{', beyond the tests' if beyond else ''}")
    if items:
        tone = "exceeded" if worst > 0.5 else "near" if worst > 1.0 - LEVEL else "within"
        if tone == "within" and (beyond or prediction.refused):
            tone = "unjudged"
        yield Statement("exceedance", f"{prediction.motion}:", items=tuple(items), tone=tone)
    if beyond:
        yield Statement(
            "beyond-tests", tone="unjudged",
            text=f"Prediction {prediction.farthest.text}. {_BAND_TEXT[prediction.hardening]}; test as far as that, or take it "
            "for an estimate.",
        )  # fmt: skip
    if prediction.refused:
        kinds = dict.fromkeys(name.partition("/")[0] for name in prediction.refused if "/" in name)
        yield Statement(
            "not-predicted", tone="unjudged",
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
        "prediction",
        f"Predicted for {prediction.motion}{', beyond the tests' if beyond else ''}",
        (
            *left("measure", "median", "from", "to"),
        ),
        rows,
        note=f"From and to hold {100.0 * LEVEL:.0f} %; errors of peaks of {100.0 * prediction.peak_error:.2g} % are in them, "
        f"and {'what the tests leave open of how the laws harden' if prediction.hardening else 'no other hardening of laws'}.",
        shown=12,
    )  # fmt: skip
