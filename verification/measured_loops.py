"""Loops of dampers that others measured: some amplitudes and rates fitted, the others calculated; play that must be named."""

import tempfile
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from scipy.optimize import minimize_scalar

import wirerope_mj as wr
from verification.case import Case, Comparison, NotRun
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.mounts.identification.records import loop_warnings, read_tests
from wirerope_mj.mounts.laws import Law

FITTED = {"0A": ("25mm0p25Hz", "2mm5Hz"), "0p5A": ("25mm0p25Hz", "2mm5Hz")}
"""Tests that are fitted, by current: the largest and the smallest amplitude; what lies between them in both is predicted."""

INCH, POUND = 0.0254, 4.4482216152605


@dataclass(frozen=True, kw_only=True)
class Record:
    """A cyclic test: instants [s], deflection [m], its rate [m/s] and force [N], each (n_t,)."""

    name: str
    time: Array
    deflection: Array
    rate: Array
    force: Array

    def written(self, folder: Path, damping: float = 0.0) -> Path:
        """Write the record as a file of the library, less the force of a damper [N s/m]."""
        path = folder / f"{self.name}.csv"
        columns = np.column_stack([self.time, self.deflection, self.force - damping * self.rate])
        np.savetxt(path, columns, delimiter=",", header="time [s], deflection [m], force [N]", comments="", fmt="%.9g")
        return path


def _records(folder: Path, kind: str, columns: tuple[str, str, str], units: tuple[float, float]) -> dict[str, Record]:
    """Read all records of a kind by name; columns are deflection, rate and force, units those of length [m] and force [N]."""
    paths = sorted((folder / kind).glob("*.parquet"))
    if not paths:
        raise NotRun(f"no data: {folder / kind} holds no records")
    found = {}
    for path in paths:
        table = pq.read_table(path)
        x, v, force = (table[name].to_numpy().astype(np.float64) for name in columns)
        time = table["time_s"].to_numpy().astype(np.float64)
        found[path.stem] = Record(
            name=path.stem, time=time, deflection=units[0] * x, rate=units[0] * v, force=units[1] * force
        )
    return found


def _fit(records: list[Record]) -> Law:
    """Identify friction and a damper beside it, whose force is what brings all rates together best."""

    @cache
    def identified(damping: float) -> wr.Identification:
        with tempfile.TemporaryDirectory() as folder:
            loops = [loop for one in records for loop in wr.load_cycles(one.written(Path(folder), damping))]
        return wr.identify(loops, law=wr.BoucWen, profiles=False)

    most = max(float(np.ptp(one.force) / np.ptp(one.rate)) for one in records)
    best = minimize_scalar(
        lambda c: identified(c).residual, bounds=(0.0, 0.5 * most), method="bounded", options={"maxiter": 8}
    )
    return wr.Parallel(laws=(identified(float(best.x)).law, wr.KelvinVoigt(k=0.0, c=float(best.x))))


def _error(law: Law, record: Record) -> tuple[float, float]:
    """Return the rms error of the force along a whole record, from its beginning: over the force range, and over its rms."""
    force = law.trace(record.deflection, time=record.time, rate=record.rate).force
    rms = float(np.sqrt(np.mean((force - record.force) ** 2)))
    return rms / float(np.ptp(record.force)), rms / float(np.sqrt(np.mean(record.force**2)))


def loops(folder: Path) -> Comparison:
    """Fit two tests of a magneto-rheological damper at each current, and predict the others."""
    records = _records(folder, "mr_damper", ("displacement_mm", "velocity_mm_s", "force_N"), (1e-3, 1.0))
    rows, lines = [], []
    for current, fitted in FITTED.items():
        names = [name for name in records if name.endswith(current) and not (current == "0A" and name.endswith("0p5A"))]
        chosen = [name + current for name in fitted]
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
        lines.append(
            f"bouc-wen, fitted to {len(paths)} records: error {100.0 * result.residual:.1f} % of half the force range"
        )
        for name, path in paths.items():
            named = [text for text in loop_warnings({path: tests[path]}, result) if "play (backlash)" in text]
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
         "tests of 25 mm at 0.25 Hz and of 2 mm at 5 Hz are fitted: Bouc-Wen's law beside a linear damper. The error is the "
         "largest rms error of the others over their force range.",
         source="magneto-rheological damper under sines: repository DanielMaurelE/vRTHS_AMBC_MRdamper, commit 08753ff "
         "(mequiroz; MIT licence)", date="2022", bound=0.08, kind="measured", run=loops,
         reason="8 % of the range: cycles of one test differ by 2 %, and one damper stands for all rates"),
    Case(name="measured-backlash", title="A friction damper with backlash, which no law here follows",
         compares="Whether the warnings of an identification name the play, in each sinusoidal test; the error is the "
         "fraction of tests in which they do not.",
         source="banded rotary friction damper (Lehigh University): repository ARTS-Laboratory/Dataset-Friction-Damper-"
         "with-Backlash, commit 0e09aa9 (University of South Carolina; CC BY-SA 4.0)", date="2023", bound=0.01,
         kind="measured", run=backlash, reason="every test must be named"),
)  # fmt: skip
