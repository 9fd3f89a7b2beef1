"""Records of an identification: reading them, warnings about them, and the isolator with the law fitted to them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from wirerope_mj.foundation.arrays import Entries
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.mounts.identification.measured import half_text, prepare
from wirerope_mj.mounts.identification.result import Identification, fitted_loops
from wirerope_mj.mounts.identification.sufficient import closes
from wirerope_mj.mounts.isolator import Isolator, Provenance, Validity
from wirerope_mj.mounts.isolator.travel import falling_text
from wirerope_mj.mounts.laws import Loop
from wirerope_mj.mounts.test_rig import load_cycles
from wirerope_mj.mounts.test_rig.faults import checked_file
from wirerope_mj.mounts.test_rig.passive import is_level
from wirerope_mj.mounts.test_rig.turning import RecordedLoop, rms_noise

Tests = Mapping[Path, Sequence[Loop]]
_Loops = Sequence[tuple[Path, Loop]]
# Fraction of the force range within which cycles that count as steady close: noise of 1 % of its half shows half of it.
_STEADY = 0.01
_ONE_CYCLE = 0.05  # The same of a single cycle, whose ends have the noise of samples
_OF_NOISE = 3.0  # Standard deviations of the noise of a mean of cycles that the ends of the last may differ by besides
# force about which a loop swings, over its range, and deflection over its amplitude, within which it swings about none
_OFFSET, _UNMOVED = 3.0, 0.2
_STIFF = 3e7  # Secant stiffness [N/m] ten times that of the stiffest part of a vendor
_SOFT = 1e3  # Secant stiffness [N/m] below which a device carries less than a kilogram on a centimetre
# Times that the stiffness of one file may be another's: amplitudes change it tenfold, a wrong unit a thousandfold.
_OTHER_UNITS = 100.0


def read_tests(files: Sequence[Path], *, stop: bool = False) -> dict[Path, list[Loop]]:
    """Read the loops of every file; RecordError names the file that cannot be used.

    A bare bump stop may have no force in some of them.
    """
    tests: dict[Path, list[Loop]] = {}
    for path in files:
        if path in tests:
            raise ValueError(f"{path} is named twice; its loops would count twice.")
        tests[path] = load_cycles(path, stop=stop)
        try:
            prepare(tests[path], stop=stop)
        except ValueError as error:
            raise RecordError(f"{path}: {error}") from None
    if stop:
        return tests
    stiffness = {path: float(np.median([loop.secant_stiffness for loop in loops])) for path, loops in tests.items()}
    soft, stiff = min(stiffness, key=stiffness.__getitem__), max(stiffness, key=stiffness.__getitem__)
    if stiffness[stiff] > _OTHER_UNITS * stiffness[soft]:
        raise RecordError(
            f"{stiff}: the secant stiffness is {stiffness[stiff]:.3g} N/m, in {soft} it is {stiffness[soft]:.3g} N/m. Are the "
            "units those that the headers say, and is it the same device?"
        )
    return tests


def rig_warnings(tests: Tests) -> tuple[list[str], dict[Path, str]]:
    """Return warnings about the rig and the loops themselves, before any fit, and by file a text on the lag between channels.

    The text gives the least lag that would have been found.
    """
    loops = [(path, loop) for path, loops in tests.items() for loop in loops]
    checked = {path: checked_file(path) for path in tests}
    faults = [text for check in checked.values() for text in check.faults]
    level = [
        f"{path}: the force of {_size(loop)} is level at an end of its stroke: the device yields there, the load cell cut "
        "a little off, or one channel lags behind the other"
        for path, loop in loops
        if is_level(loop)
    ]
    stiffness = {path: max(loop.secant_stiffness for loop in tested) for path, tested in tests.items()}
    soft = [
        f"{path}: its secant stiffness of at most {size:.3g} N/m is that of a very soft device; "
        "are the forces in kN where N is said?"
        for path, size in stiffness.items()
        if size < _SOFT
    ]
    least = {path: min(loop.secant_stiffness for loop in tested) for path, tested in tests.items()}
    stiff = [
        f"{path}: its secant stiffness of at least {size:.3g} N/m is that of no isolator of wire rope; are the forces in N "
        "where kN is said, or the deflections in m where mm is?"
        for path, size in least.items()
        if size > _STIFF
    ]
    return [*faults, *_unsteady(loops), *level, *soft, *stiff, *_off_zero(tests)], {
        path: "; a lag between its channels, of whatever size, cannot be told: that takes a time, no play and three "
        "reversals in turn between like strokes, as two and a half cycles of an amplitude have"
        if math.isnan(check.least_lag)
        else f"; a lag between its channels is named from {100.0 * check.least_lag:.2g} % of a cycle on"
        for path, check in checked.items()
    }


def _off_zero(tests: Tests) -> Iterator[str]:
    """Yield a warning of each file whose largest loop swings about no deflection, and a force far beyond its range."""
    for path, tested in tests.items():
        loop = max(tested, key=lambda candidate: candidate.amplitude)
        force, deflection = (0.5 * float(values.max() + values.min()) for values in (loop.force, loop.deflection))
        swing = float(np.ptp(loop.force))
        if abs(force) > _OFFSET * swing and abs(deflection) < _UNMOVED * loop.amplitude:
            yield (
                f"{path}: its largest loop, {_size(loop)}, swings about {force:.4g} N with a range of {swing:.4g} N: is the "
                "load cell's zero off, or is the deflection counted from where a preload holds the device? Take the zero "
                "off, or count deflections from the unloaded device."
            )


def loop_warnings(tests: Tests, result: Identification) -> tuple[list[str], dict[Path, str]]:
    """Return warnings about rig and loops that make a fit doubtful, and by file a text on the least lag that would be found.

    Of a bare stop, loops within its gap are named.
    """
    loops = [(path, loop) for path, loops in tests.items() for loop in loops]
    if not result.law.only_stops:
        warnings, lags = rig_warnings(tests)
        return [*warnings, *_unexplained(loops, result)], lags
    inside = [pair for pair in loops if not closes(prepare([pair[1]], stop=True)[0])]
    closed = [pair for pair in loops if not any(pair[1] is loop for _, loop in inside)]
    warnings = [f"{path}: {_size(loop)} stays within the gap and is not fitted" for path, loop in inside]
    return [*warnings, *_unsteady(closed), *_unexplained(closed, result)], {}


def _unsteady(loops: _Loops) -> list[str]:
    """Warn of each loop that counts as steady and still changes from cycle to cycle, by more than its noise."""
    return [
        f"{path}: {_size(loop)} is not steady, its last cycle ends {100.0 * loop.closure:.2g} % of its force range from where "
        f"it began{half_text(loop)}, and is fitted as if it were: parameters may be off by more than their errors. Record the "
        "way from the unloaded device, or more cycles"
        for path, loop in loops
        if not (isinstance(loop, RecordedLoop) and loop.averaged)
        and loop.closure > (_STEADY if loop.cycles > 1 else _ONE_CYCLE) + _OF_NOISE * rms_noise(loop.force) / np.ptp(loop.force)
    ]


def _unexplained(loops: _Loops, result: Identification) -> list[str]:
    """Warn of each loop whose last cycle ends elsewhere than that of the law, led there likewise from the unloaded device."""
    warnings = []
    for path, loop in loops:
        if not (isinstance(loop, RecordedLoop) and loop.averaged > 1):
            continue
        law_closure = prepare([loop], stop=result.law.only_stops)[0].law_closure(result.law)
        # Besides its noise, which the residual is a measure of.
        if abs(loop.closure - law_closure) > _STEADY + result.residual:
            warnings.append(
                f"{path}: the last cycle of {_size(loop)} ends {100.0 * loop.closure:.2g} % of its force range from where it "
                f"began, the law's {100.0 * law_closure:.2g} %: was the device unloaded when the record began? If not, "
                "parameters may be off by more than their errors; record all amplitudes in one, or more cycles"
            )
    return warnings


def contents(loops: Sequence[Loop]) -> str:
    return ", ".join(f"{_size(loop)} ({loop.cycles} cycles)" for loop in loops)


def millimetres(deflection: float) -> str:
    """Write a deflection [m] in mm to 1 um: less is noise, and must not look like an operating point."""
    return f"{round(1e3 * deflection, 3) + 0.0:.6g}"


def _size(loop: Loop) -> str:
    return f"±{1e3 * loop.amplitude:.3g} mm about {millimetres(loop.operating_point)} mm"


def identified_isolator(
    result: Identification, *, name: str, axis: str, files: Sequence[Path], given: Sequence[str],
    known: Isolator | None = None, whole: Isolator | None = None,
) -> Isolator:  # fmt: skip
    """Make an isolator called `name` with the law of an identification on the axis that was tested.

    `files` are the records that were fitted, `given` is what was given to the fit, one text each. `known` is an isolator
    whose law on the axis was known: its limits, geometry and other axes stay; `whole` is one to which the axis is added, or
    whose axis is replaced: all else of it stays, too.
    """
    fits = fitted_loops(result)
    sizes = ", ".join(f"{1e3 * fit.measured.amplitude:.3g} ({100.0 * fit.error:.2g} %)" for fit in fits)
    points = sorted({round(1e3 * fit.measured.operating_point, 1) + 0.0 for fit in fits})
    assumed = [*assumptions(result, given), *(f"the data do not identify: {text}" for text in result.non_identifiable)]
    if falling := result.falling or falling_in_rating(result, axis, whole or known):
        assumed.append(f"{falling}: the law does not hold there")
    if not result.converged:
        assumed.append(f"the fit did not converge ({result.message})")
    provenance = Provenance(
        kind="identified",
        source=f"cyclic tests: {', '.join(path.name for path in files)}",
        fitted_to=(
            f"{axis} force over cycles of amplitude [mm] (error of the force over half its range) {sizes}, "
            f"about {', '.join(f'{point:g}' for point in points)} mm; {result.validity}"
        ),
        assumed=tuple(assumed),
    )
    axes: Entries = {axis: result.law}
    if whole is not None:
        validity = replace(whole.validity, **{axis: result.measured})
        before = whole.provenance
        provenance = replace(
            provenance,
            source="; ".join(filter(None, [before.source, provenance.source])),
            fitted_to="; ".join(filter(None, [before.fitted_to, provenance.fitted_to])),
            assumed=(*before.assumed, *(f"{axis}: {text}" for text in provenance.assumed)),
        )
        return replace(whole, name=name, provenance=provenance, spread=None, validity=validity, **axes)
    if known is None:
        return Isolator(name=name, provenance=provenance, validity=Validity(**{axis: result.measured}), **axes)
    joined = result.measured.joined(known.validity.stated.get(axis))
    validity = replace(known.validity, **{axis: joined})
    return replace(known.conditioned, name=name, provenance=provenance, spread=None, validity=validity, **axes)


def falling_in_rating(result: Identification, axis: str, rated: Isolator | None) -> str:
    """Say from which deflections on the law's tangent stiffness is negative within the rated travel, if the fit says of none.

    "" where it is not, where no isolator says a rating, and where it already is within twice what was tested, as the fit says.
    """
    if rated is None or result.falling:
        return ""
    below, above = (travel or 0.0 for travel in rated.rated_travel(axis))
    return falling_text(result.law, -below, above)


def turned_round(result: Identification, axis: str) -> str:
    """Return a question about signs if the axial law stiffens in compression, not in tension as wire rope; else ""."""
    p = result.parameters.get("c_ln_b")
    if axis != "axial" or p is None or p.fixed or p.value + 2.0 * p.standard_error >= 0.0:
        return ""
    return (
        f"the law stiffens in compression (c ln b = {p.value:.3g} 1/m), where wire rope stiffens in tension: does the record "
        "count compression as positive? Then change the signs of deflection and force"
    )


def assumptions(result: Identification, given: Sequence[str]) -> list[str]:
    """List the assumptions of a fit, as texts of its provenance."""
    texts = [f"{text}: given, not fitted" for text in given]
    if "c_ln_b" in result.parameters:
        texts.append("b = e: of b and c only the product c ln b acts on the force")
    return [*texts, "the force's zero: the mean of each loop's force was free, so that the law has no force unloaded"]
