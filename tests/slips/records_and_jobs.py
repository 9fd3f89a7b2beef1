"""Slips in records, cyclic tests, densities, spectra, levels, jobs and studies, as people of the field make them."""

import re
from collections.abc import Callable

import numpy as np
import scipy

from tests.slips.measured_inputs import (
    DENSITIES,
    DOUBLE_PULSES,
    DROPS,
    JOBS,
    LOOPS,
    PULSES,
    RECORDS,
    SHOCKS,
    SPECTRA,
    STUDIES,
    SWEEPS,
    VELOCITIES,
    WIDE_LOOPS,
    WITH_GRAVITY,
    G,
    levels_base,
)
from tests.slips.planting import Slip
from wirerope_mj.foundation.arrays import Array

Plant = Callable[[str], str]


def on_rows(change: Callable[[Array], Array]) -> Plant:
    """Return a change of a table's numbers, (n, columns), below its header."""

    def plant(text: str) -> str:
        header, *lines = text.splitlines()
        rows = change(np.array([[float(cell) for cell in line.split(",")] for line in lines]))
        return "\n".join([header, *(",".join(f"{value:.7g}" for value in row) for row in rows)]) + "\n"

    return plant


def times(*factors: float) -> Plant:
    return on_rows(lambda rows: rows * np.array(factors))


def in_place_of(old: str, new: str | Callable[[re.Match[str]], str]) -> Plant:
    """Return a change of what a pattern matches, everywhere."""
    return lambda text: re.sub(old, new, text)


def both(first: Plant, second: Plant) -> Plant:
    return lambda text: second(first(text))


def course(change: Callable[[Array, Array], Array]) -> Plant:
    """Return a change of a record's last column, given with its time."""
    return on_rows(lambda rows: np.column_stack([rows[:, :-1], change(rows[:, 0], rows[:, -1])]))


def filtered(kind: str, frequency: float, order: int) -> Plant:
    """Return what a filter of a charge amplifier, or before a converter, leaves of a record."""

    def change(time: Array, a: Array) -> Array:
        sections = scipy.signal.butter(order, frequency, kind, fs=(time.size - 1) / (time[-1] - time[0]), output="sos")
        return scipy.signal.sosfilt(sections, a)

    return course(change)


def _slower(rows: Array) -> Array:
    """Sample a record so rarely that its pulse has two or three samples."""
    return rows[:: np.count_nonzero(np.abs(rows[:, 1]) > 0.1 * np.abs(rows[:, 1]).max()) // 3 + 1]


def _jumping(rows: Array) -> Array:
    late = rows.copy()
    late[rows.shape[0] // 2 :, 0] += 0.5
    return late


def _repeating(rows: Array) -> Array:
    middle = rows.shape[0] // 2
    return np.concatenate([rows[:middle], rows[middle - 1 : middle], rows[middle:]])


def _backwards(rows: Array) -> Array:
    late = rows.copy()
    late[rows.shape[0] // 2 :, 0] -= rows[rows.shape[0] // 4, 0]
    return late


def _two_rates(rows: Array) -> Array:
    middle = rows.shape[0] // 2
    return np.concatenate([rows[:middle], rows[middle::4]])


def _cut(rows: Array) -> Array:
    return rows[: int(np.argmax(np.abs(rows[:, 1]))) + 1]


def _shifted_zero(time: Array, a: Array) -> Array:
    return a + np.where(time > time[int(np.argmax(np.abs(a)))], 0.06 * np.ptp(a), 0.0)


def _spiked(time: Array, a: Array) -> Array:
    spiked = a.copy()
    spiked[time.size // 10] = 3.0 * np.abs(a).max()
    return spiked


def _clipped(_: Array, a: Array) -> Array:
    limit = round(0.6 * float(np.abs(a).max()), 4)
    return np.clip(a, -limit, limit)


GRAVITY = "gravity"
OTHER_UNIT = r"--unit|in another unit|unit of time|its unit"
IN_RECORDS = (
    Slip("acceleration in g, header says m/s^2", WITH_GRAVITY, in_place_of(r"z \[g\]", "z [m/s^2]"), "gravity if .* in g "),
    Slip("acceleration in m/s^2, header says g", WITH_GRAVITY, times(1.0, G), r"gravity if .* in m/s\^2"),
    Slip("acceleration in mm/s^2, header says m/s^2", WITH_GRAVITY,
         both(times(1.0, 1e3 * G), in_place_of(r"\[g\]", "[m/s^2]")), r"mm/s\^2|by a factor of 1000"),
    Slip("acceleration in m/s^2, header says mm/s^2", WITH_GRAVITY,
         both(times(1.0, G), in_place_of(r"\[g\]", "[mm/s^2]")), r"m/s\^2"),
    Slip("acceleration in mg, header says g", WITH_GRAVITY, times(1.0, 1e3), "mg|factor of .*1000"),
    Slip("acceleration in in/s^2, header says m/s^2", WITH_GRAVITY,
         both(times(1.0, G / 0.0254), in_place_of(r"\[g\]", "[m/s^2]")), r"in/s\^2"),
    Slip("acceleration in gal, header says m/s^2", WITH_GRAVITY,
         both(times(1.0, 100.0 * G), in_place_of(r"\[g\]", "[m/s^2]")), "gal"),
    Slip("time in ms, header says s", RECORDS, times(1e3, 1.0), "time in another unit"),
    Slip("time in s, header says us", RECORDS, in_place_of(r"time \[s\]", "time [us]"), "time in another unit"),
    Slip("clock jumps", RECORDS, on_rows(_jumping), "gap"),
    Slip("clock repeats an instant", RECORDS, on_rows(_repeating), "[Tt]ime|instant"),
    Slip("clock runs backwards", RECORDS, on_rows(_backwards), "[Tt]ime|instant"),
    Slip("two rates in one file", RECORDS, on_rows(_two_rates), "not uniform|gap"),
    Slip("rate too low for the pulse", SHOCKS, on_rows(_slower), "higher rate"),
    Slip("zero off by 3 %", RECORDS, course(lambda time, a: a + 0.03 * np.abs(a).max()), "stands off zero|rests at"),
    Slip("zero drifts", RECORDS, course(lambda time, a: a + 0.1 * np.abs(a).max() * time / time[-1]),
         "drift|zero moves|highpass"),
    Slip("AC-coupled at 3 Hz", SHOCKS, filtered("highpass", 3.0, 1), "AC coupling"),
    Slip("clipped by the amplifier", RECORDS, course(_clipped), "saturated"),
    Slip("cut off before it rests", RECORDS, on_rows(_cut), "shorter than its pulse|cut out of a longer"),
    Slip("zero shifted by the shock", SHOCKS, course(_shifted_zero), "level changes"),
    Slip("a spike of the chain", RECORDS, course(_spiked), "stands alone"),
    Slip("gravity left in the record", RECORDS, course(lambda time, a: a + 1.0), "gravity were in it|stands off zero by 1"),
    Slip("vertical sensor read as x", WITH_GRAVITY, in_place_of(r"z \[g\]", "x [g]"), "gravity.*(along x|direction)"),
    Slip("sensor upside down", WITH_GRAVITY, times(1.0, -1.0), "upside down|sense|-z"),
    Slip("time column missing", RECORDS, both(on_rows(lambda rows: rows[:, 1:]), in_place_of(r"time \[s\],", "")), "time"),
    Slip("decimal comma in columns of commas", RECORDS, in_place_of(r"\.", ","), "comma|columns|cells|numbers"),
    Slip("velocity for acceleration", RECORDS, in_place_of(r"z \[g\]", "z [m/s]"), r"m/s"),
    Slip("no unit in the header", RECORDS, in_place_of(r" \[g\]", ""), "unit"),
    Slip("channel not connected", RECORDS, course(lambda time, a: 0.0 * a), "zero"),
    Slip("peaks beyond the sensor's range", RECORDS, in_place_of(r"z \[g\]", "z [1g]"), "range"),
    Slip("rate too low for the vibration", (RECORDS[1],), on_rows(lambda rows: rows[::8]), "higher rate",
         untold="Noise that is folded is noise: nothing in it says where it came from."),
    Slip("filtered at 60 Hz", (RECORDS[0],), filtered("lowpass", 60.0, 4), "filter",
         untold="A rounded pulse is what a softer pad or a programmer makes, and every record falls off below half its rate."),
    Slip("inverted sign", (RECORDS[0],), times(1.0, -1.0), "sign",
         untold="A shock has either sense; gravity in the record tells, and is asked for above."),
)  # fmt: skip


def _half_cycles(rows: Array) -> Array:
    return rows[: int(rows.shape[0] / 15 * 0.6)]


def _lagging(rows: Array) -> Array:
    late = rows[5:].copy()
    late[:, 2] = rows[:-5, 2]
    return late


def _hum(rows: Array) -> Array:
    time = rows[:, 0] / 4.0  # 400 samples a second: what the mains add is seen
    return np.column_stack([time, rows[:, 1], rows[:, 2] + 0.02 * np.ptp(rows[:, 2]) * np.sin(2.0 * np.pi * 50.0 * time)])


def _saturated(rows: Array) -> Array:
    limit = round(0.35 * float(np.ptp(rows[:, 2])), 2)
    return np.column_stack([rows[:, :2], np.clip(rows[:, 2], -limit, limit)])


def _with_play(rows: Array) -> Array:
    """Let the piston run through a play, without force, wherever the force changes its sign."""
    force, play, ways = rows[:, 2], 0.1 * float(rows[:, 1].max()), np.linspace(-0.5, 0.5, 12)[1:-1]
    side, moved = 1.0, []
    for x, f in rows[:, 1:]:
        if f * side < -0.02 * force.max():  # beyond its noise
            side = -side
            moved += [[x + play * side * way, 0.0] for way in ways]
        moved.append([x + 0.5 * play * side, f])
    return np.column_stack([0.01 * np.arange(len(moved)), np.array(moved)])


def _creeping_zero(rows: Array) -> Array:
    return rows + np.outer(rows[:, 0] / rows[-1, 0], [0.0, 0.0, 0.15 * float(np.ptp(rows[:, 2]))])


def _two_tests(text: str) -> str:
    return text + "".join(text.splitlines(keepends=True)[1:])


IN_LOOPS = (
    Slip("force in kN, header says N", LOOPS, times(1.0, 1.0, 1e-3), "kN where N"),
    Slip("force in N, header says kN", LOOPS, in_place_of(r"\[N\]", "[kN]"), "N where kN"),
    Slip("deflection in mm, header says m", LOOPS, in_place_of(r"\[mm\]", "[m]"), "mm where metres|mm"),
    Slip("deflection in m, header says mm", LOOPS, times(1.0, 1e-3, 1.0), "deflections in another unit|deflections in m"),
    Slip("sign of the force inverted", LOOPS, times(1.0, 1.0, -1.0), "force falls where the deflection grows"),
    Slip("columns of force and deflection swapped", LOOPS,
         in_place_of(r"deflection \[mm\],force \[N\]", "force [N],deflection [mm]"), "amplitude|units|swapped"),
    Slip("order of the samples reversed", LOOPS, on_rows(lambda rows: np.column_stack([rows[:, 0], rows[::-1, 1:]])),
         "energy|gives .* J away"),
    Slip("load cell saturated", LOOPS, on_rows(_saturated), "saturated"),
    Slip("half a cycle", LOOPS, on_rows(_half_cycles), "full cycle|no cycle|one cycle"),
    Slip("force lags by 50 ms", LOOPS, on_rows(_lagging), "force channel lags|give.* away|order of the samples"),
    Slip("zero of the load cell drifts", LOOPS, on_rows(_creeping_zero), "zero of the force drifts"),
    Slip("hum of the mains", LOOPS, on_rows(_hum), "hum"),
    Slip("play in the fixture", WIDE_LOOPS, on_rows(_with_play), "play"),
    Slip("play in the fixture of thin loops", LOOPS[::2], on_rows(_with_play), "play",
         untold="A dead zone at one deflection, both ways, is what a spring shows that is soft in its middle."),
    Slip("two tests in one file", LOOPS, _two_tests, "[Tt]ime must increase|goes on here"),
    Slip("force channel dead", LOOPS, times(1.0, 1.0, 0.0), "force never changes"),
)  # fmt: skip

IN_DENSITIES = (
    Slip("density in (m/s^2)^2/Hz, header says g^2/Hz", DENSITIES, times(1.0, G**2), r"where g\^2/Hz", file="psd.csv"),
    Slip("frequency in rad/s, header says Hz", DENSITIES, times(2.0 * np.pi, 1.0), "rad/s", file="psd.csv"),
    Slip("frequency in kHz, header says Hz", DENSITIES, times(1e-3, 1.0), "kHz|frequenc", file="psd.csv"),
    Slip("amplitude g/rtHz for a density", DENSITIES, in_place_of(r"\[g\^2/Hz\]", "[g/rtHz]"), r"g/rtHz", file="psd.csv"),
    Slip("levels in dB", DENSITIES, in_place_of(r"psd \[g\^2/Hz\]", "psd [dB]"), "dB", file="psd.csv"),
    Slip("vibration shorter than its lowest period", DENSITIES, in_place_of("30 s", "30 ms"), "rise|period|duration|length"),
    Slip("rows out of order", DENSITIES, on_rows(lambda rows: rows[::-1]), "increase", file="psd.csv"),
    Slip("a level of zero", DENSITIES, on_rows(lambda rows: rows * np.where(rows[:, :1] == rows[1, 0], [[1.0, 0.0]], 1.0)),
         "must be", file="psd.csv"),
    Slip("density in g^2/Hz, header says (m/s^2)^2/Hz", DENSITIES, in_place_of(r"g\^2/Hz", "(m/s^2)^2/Hz"), "unit",
         file="psd.csv", untold="Half a g rms is transport by rail or the vibration of a ship: nothing is wrong with it."),
    Slip("two-sided density", DENSITIES, times(1.0, 0.5), "two-sided", file="psd.csv",
         untold="The same density at 3 dB less is a specification of its own."),
)  # fmt: skip
IN_SPECTRA = (
    Slip("damping as a number without per cent", SPECTRA, in_place_of(r"damping \d %", "damping 0.05"), "unit|%"),
    Slip("Q for a damping ratio", SPECTRA, in_place_of(r"damping \d %", "Q 10"), "Q"),
    Slip("damping of 0.05 %", SPECTRA, in_place_of(r"damping \d %", "damping 0.05 %"), "damping"),
    Slip("periods for frequencies", SPECTRA, in_place_of(r"frequency \[Hz\]", "period [s]"), "period.*Hz", file="rrs.csv"),
    Slip("displacement for acceleration", SPECTRA, in_place_of(r"acceleration \[g\]", "displacement [mm]"), "acceleration|unit",
         file="rrs.csv"),
)  # fmt: skip
IN_LEVELS = (
    Slip("length in s for ms", PULSES, in_place_of(" ms", " s"), "ms meant"),
    Slip("a length of 0.011 ms", PULSES, in_place_of(r"(\d+) ms", r"0.0\1 ms"), "was .* s meant|length"),
    Slip("peak in m/s^2 said as g", PULSES, in_place_of(r"(\d+) g", lambda m: f"{float(m[1]) * G:.0f} g"), r"m/s\^2"),
    Slip("peak in mm/s^2 said as m/s^2", PULSES, in_place_of(r"(\d+) g", lambda m: f"{float(m[1]) * 1e3 * G:.0f} m/s^2"),
         r"mm/s\^2"),
    Slip("units of peak and length swapped", PULSES, in_place_of(r"(\d+) g (\d+) ms", r"\1 ms \2 s"),
         "acceleration must stand"),
    Slip("peak without a unit", PULSES, in_place_of(r"(\d+) g", r"\1"), "no unit|unit"),
    Slip("level in dB", PULSES, in_place_of(r"(\d+) g", r"\1 dB"), "dB"),
    Slip("decimal comma", PULSES, in_place_of(r"(\d+) g", r"\1,5 g"), "point"),
    Slip("factor in per cent", PULSES, lambda text: text + "factor = 150\n", "factor"),
    Slip("key of no motion", PULSES, in_place_of(r"\n(\S+) =", r"\n\1-shock ="), "half-sine"),
    Slip("level left open", PULSES, in_place_of(r"(\d+) g", "? g"), "still open"),
    Slip("sweep from 0 Hz", SWEEPS, in_place_of(r"\d+ to", "0 to"), "start"),
    Slip("sweep rate in Hz/s", SWEEPS, in_place_of("oct/min", "Hz/s"), "oct/min"),
    Slip("sweep rate per second", SWEEPS, in_place_of("oct/min", "oct/s"), "oct/min"),
    Slip("sweep in kHz", SWEEPS, in_place_of("Hz", "kHz"), "Hz"),
    Slip("displacement in m for mm", DOUBLE_PULSES, in_place_of(" mm", " m"), "unit"),
    Slip("velocity in mm/s for m/s", DOUBLE_PULSES, in_place_of("m/s", "mm/s"), "unit|velocity"),
    Slip("velocity in mm/s said as m/s", VELOCITIES, in_place_of(r"([\d.]+) m/s", lambda m: f"{1e3 * float(m[1]):g} m/s"),
         "unit"),
    Slip("height in mm said as m", DROPS, in_place_of(" mm", " m"), "in mm"),
    Slip("pulse of 11 g 15 ms for 15 g 11 ms", (levels_base("half-sine", "half-sine", "15 g 11 ms z"),),
         in_place_of("15 g 11 ms", "11 g 15 ms"), "swapped", untold="Both are severities that people test with."),
)  # fmt: skip
IN_JOBS = (
    Slip("limit of another body", JOBS, in_place_of("acceleration/[a-z]+", "acceleration/camera"), "camera"),
    Slip("limit of another point", JOBS, in_place_of(r"clearance/\w+", "clearance/mast_top"), "mast_top"),
    Slip("clearance in mm said as m", JOBS, in_place_of(r" mm", " m"), "clearance"),
    Slip("clearance in m said as mm", JOBS, in_place_of(r"(\d)0 (\d)0 (\d)0 mm", r"0.0\1 0.0\2 0.0\3 mm"), "clearance"),
    Slip("limit without a unit", JOBS, in_place_of(r'(\d+) g"', r'\1"'), "unit"),
    Slip("load in N said as kN below what gravity makes", JOBS, in_place_of(r"(\d) kN", r"\1 N"), "load"),
    Slip("acceleration limit in m/s^2 said as mm/s^2", JOBS, in_place_of(r'(\d+) g"', r'\1 mm/s^2"'),
         r"unit mm/s\^2"),
    Slip("damping of the deck as a ratio said in per cent", JOBS, in_place_of(r"(\d) %", r"0.0\1 %"), "damping"),
    Slip("damping of the deck without per cent", JOBS, in_place_of(r"(\d) %", r"0.0\1"), "unit|%"),
    Slip("mass of the deck in t said as kg", JOBS, in_place_of(r" (\d+) kg", lambda m: f" {int(m[1]) / 1e3:g} kg"), "mass"),
    Slip("frequency of the deck in kHz", JOBS, in_place_of(r'"(\d+) Hz', r'"\1 kHz'), "frequency"),
    Slip("model that is not there", JOBS, in_place_of('model = "', 'model = "my_'), "my_"),
    Slip("record that is not there", JOBS, in_place_of('"record.csv"', '"shock_1.csv"'), "shock_1.csv"),
    Slip("two cases of one name", JOBS, in_place_of('"measured"', '"vertical shock"'), "twice"),
    Slip("key misspelt", JOBS, in_place_of("baseline", "base-line"), "base-line"),
    Slip("case without a motion", JOBS, in_place_of(r'(half-sine|double-pulse|sawtooth) = .*', ""), "no motion"),
    Slip("case of a length in ms", JOBS, in_place_of(r"duration = 0.5", "duration = 500"), "duration|s meant|ms"),
    Slip("frequency of the deck in rad/s", JOBS, in_place_of(r'"(\d+) Hz', lambda m: f'"{6.283 * int(m[1]):.1f} Hz'), "rad/s",
         untold="A stiff panel of 50 to 160 Hz is as usual as a soft one."),
)  # fmt: skip
IN_STUDIES = (
    Slip("deviation in per cent", STUDIES, in_place_of(r"Normal\(1, 0\.0?(\d+),", r"Normal(1, \1,"), "low="),
    Slip("mean and deviation in per cent", STUDIES, in_place_of(r"Normal\(1, 0\.0?(\d+),", r"Normal(100, \1,"), "is a factor"),
    Slip("factor without `relative`", STUDIES, in_place_of(", relative", ""), "say `relative`"),
    Slip("mount that is not there", STUDIES, in_place_of(r"mount/m\S+?/", "mount/iso1/"), "iso1"),
    Slip("quantity that is not there", STUDIES, in_place_of("stiffness", "k"), r"'k'|parameter|factor"),
    Slip("body that is not there", STUDIES, in_place_of("body/[a-z]+", "body/cabin"), "cabin"),
    Slip("bounds the wrong way round", STUDIES, in_place_of(r"Normal\(1, 0\.\d+", "Uniform(1.1, 0.9"), "revers"),
    Slip("shift of a mount in mm", STUDIES, lambda text: text + "\nmount/m*/position_shift/x = Normal(0, 5)",
         "numbers in mm"),
    Slip("distribution misspelt", STUDIES, in_place_of("Normal", "Gauss"), "no distribution"),
)  # fmt: skip
SLIPS = (
    *IN_RECORDS, *IN_LOOPS, *IN_DENSITIES, *IN_SPECTRA, *IN_LEVELS, *IN_JOBS, *IN_STUDIES,
)  # fmt: skip
