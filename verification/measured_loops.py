"""Loops of dampers that others measured: some amplitudes and rates fitted, the others calculated; play that must be named."""

import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from scipy.optimize import least_squares

import wirerope_mj as wr
from verification.case import Case, Comparison, NotRunError
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.records import loop_warnings, read_tests
from wirerope_mj.mounts.laws import Law

CURRENTS, FITTED = ("0A", "0p5A"), ("25mm0p25Hz", "5mm3Hz")
"""Currents, and the tests that are fitted of each: the largest amplitude and the fastest; between and below are the others."""

SAMPLES = 1200
"""Of a fitted record: a few dozen to a cycle."""

INCH, POUND = 0.0254, 4.4482216152605


@dataclass(frozen=True, kw_only=True)
class Record:
    """A cyclic test: instants [s], deflection [m], its rate [m/s] and force [N], each (n_t,)."""

    name: str
    time: Array
    deflection: Array
    rate: Array
    force: Array

    def thinned(self) -> "Record":
        """Return the record with about `SAMPLES` samples."""
        every = slice(None, None, max(1, self.time.size // SAMPLES))
        parts = {name: getattr(self, name)[every] for name in ("time", "deflection", "rate", "force")}
        return Record(name=self.name, **parts)

    def traced(self, law: Law) -> Array:
        """Return the force of a law along the record [N], (n_t,)."""
        return law.trace(self.deflection, time=self.time, rate=self.rate).force

    def written(self, folder: Path) -> Path:
        """Write the record as a file of the library."""
        path = folder / f"{self.name}.csv"
        columns = np.column_stack([self.time, self.deflection, self.force])
        np.savetxt(path, columns, delimiter=",", header="time [s], deflection [m], force [N]", comments="", fmt="%.9g")
        return path


def _records(folder: Path, kind: str, columns: tuple[str, str, str], units: tuple[float, float]) -> dict[str, Record]:
    """Read all records of a kind by name; columns are deflection, rate and force, units those of length [m] and force [N]."""
    paths = sorted((folder / kind).glob("*.parquet"))
    if not paths:
        raise NotRunError(f"no data: {folder / kind} holds no records")
    found = {}
    for path in paths:
        table = pq.read_table(path)
        x, v, force = (table[name].to_numpy().astype(np.float64) for name in columns)
        time = table["time_s"].to_numpy().astype(np.float64)
        found[path.stem] = Record(name=path.stem, time=time, deflection=units[0] * x, rate=units[0] * v, force=units[1] * force)
    return found


def _law(logs: Array, force: float) -> Law:
    """Make Bouc-Wen's friction, friction that comes with the rate, a damper and a spring from logarithms over rough values.

    Rough values are those of dampers of this size: 1 mm and 10 mm/s until friction has come, half of the force each.
    """
    z_max, x_y, friction, smoothing, damping, spring = np.exp(logs).tolist()
    hysteretic = wr.BoucWen.from_normalised(z_max=0.5 * force * z_max, x_y=1e-3 * x_y, sigma=0.5, n=1.0, k=0.0)
    with_rate = wr.TinkerCutchins(k1=force * spring, f0=0.5 * force * friction, smoothing=0.01 * smoothing, c=force * damping)
    return wr.Parallel(laws=(hysteretic, with_rate))


def _fit(records: list[Record]) -> Law:
    """Fit the law to whole records, each over its force range."""
    force, thin = 0.5 * float(np.ptp(records[0].force)), [one.thinned() for one in records]

    def residual(logs: Array) -> Array:
        law = _law(logs, force)
        return np.concatenate([(one.traced(law) - one.force) / (np.ptp(one.force) * one.time.size**0.5) for one in thin])

    found = least_squares(residual, np.zeros(6), bounds=(-7.0, 7.0), x_scale=0.3, diff_step=1e-3)
    return _law(found.x, force)


def _error(law: Law, record: Record) -> tuple[float, float]:
    """Return the rms error of the force along a whole record, from its beginning: over the force range, and over its rms."""
    rms = float(np.sqrt(np.mean((record.traced(law) - record.force) ** 2)))
    return rms / float(np.ptp(record.force)), rms / float(np.sqrt(np.mean(record.force**2)))


def loops(folder: Path) -> Comparison:
    """Fit two tests of a magneto-rheological damper at each current, and predict the others."""
    records = _records(folder, "mr_damper", ("displacement_mm", "velocity_mm_s", "force_N"), (1e-3, 1.0))
    rows, lines = [], []
    for current in CURRENTS:
        names = [name for name in records if name.endswith(current) and not (current == "0A" and name.endswith("0p5A"))]
        chosen = [name + current for name in FITTED]
        law = _fit([records[name] for name in chosen])
        for name in names:
            of_range, of_rms = _error(law, records[name])
            held_out = name not in chosen
            lines.append(
                f"{name} {'predicted' if held_out else 'fitted'}: rms error {100.0 * of_range:.1f} % of the force range, "
                f"{100.0 * of_rms:.1f} % of the rms force"
            )
            if held_out:
                rows.append((f"{name}, rms error over the force range", 0.0, of_range, of_range))
    worst = max(rows, key=lambda row: row[3])
    return Comparison(
        reference=0.0,
        ours=worst[2],
        error=worst[3],
        values=len(rows),
        unit="of the range",
        details=tuple(rows),
        lines=tuple(lines),
    )


def backlash(folder: Path) -> Comparison:
    """Identify a law from a damper with play, and see whether the tool says that no law follows it, and why."""
    columns = ("displacement_in", "velocity_in_s", "friction_force_kip")
    records = _records(folder, "friction_damper", columns, (INCH, 1e3 * POUND))
    sines = {name: record for name, record in records.items() if "Hz" in name}
    rows, lines = [], []
    with tempfile.TemporaryDirectory() as place, warnings.catch_warnings():
        warnings.simplefilter("ignore", wr.RecordWarning)
        paths = {name: record.written(Path(place)) for name, record in sines.items()}
        tests = read_tests(list(paths.values()))
        result = wr.identify([loop for each in tests.values() for loop in each], law=wr.BoucWen, profiles=False)
        lines.append(f"bouc-wen, fitted to {len(paths)} records: error {100.0 * result.residual:.1f} % of half the force range")
        for name, path in paths.items():
            named = [text for text in loop_warnings({path: tests[path]}, result)[0] if "play (backlash)" in text]
            lines += [text.replace(str(path), name) for text in named]
            rows.append((f"{name}, play named", 1.0, float(bool(named)), float(not named)))
    missed = float(np.mean([row[3] for row in rows]))
    return Comparison(
        reference=1.0,
        ours=1.0 - missed,
        error=missed,
        values=len(rows),
        unit="of the records",
        details=tuple(rows),
        lines=tuple(lines),
    )


CASES = (
    Case(name="measured-loops", title="A magneto-rheological damper, amplitudes and rates that were not fitted",
         compares="Force along whole records, without current (nearly rate-independent friction) and at 0.5 A. Of each the "
         "tests of 25 mm at 0.25 Hz and of 5 mm at 3 Hz are fitted, bouc-wen beside tinker-cutchins. The error is the largest "
         "rms error of the others over their force range; lines give it over the rms force, too.",
         source="magneto-rheological damper under sines: repository DanielMaurelE/vRTHS_AMBC_MRdamper, commit 08753ff "
         "(mequiroz; MIT licence)", date="at that commit", bound=0.08, kind="measured", run=loops,
         reason="8 % of the range: cycles of the slowest test without current differ by up to 6 % of it"),
    Case(name="measured-backlash", title="A friction damper with backlash, which no law here follows",
         compares="Whether the warnings of an identification name the play, in each sinusoidal test; the error is the "
         "fraction of tests in which they do not.",
         source="banded rotary friction damper (Lehigh University): repository ARTS-Laboratory/Dataset-Friction-Damper-"
         "with-Backlash, commit 0e09aa9 (University of South Carolina; CC BY-SA 4.0)", date="at that commit", bound=0.01,
         kind="measured", run=backlash, reason="every test must be named"),
)  # fmt: skip
