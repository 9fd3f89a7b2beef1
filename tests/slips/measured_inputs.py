"""Inputs as loggers, rigs and specifications give them, without a slip: records, cyclic tests, tables, load cases, studies."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import scipy

import wirerope_mj as wr
from tests.slips.planting import Base
from wirerope_mj.foundation.arrays import Array
from wirerope_mj.motions.registry import motion_of_levels
from wirerope_mj.mounts.identification.records import read_tests, rig_warnings
from wirerope_mj.mounts.laws import Law
from wirerope_mj.studies.vary.vary_option import read_vary

G = 9.80665


def _noise(size: int, level: float, seed: int) -> Array:
    return level * np.random.default_rng(seed).standard_normal(size)


def _table(header: str, *columns: Array) -> str:
    """Return the text of a CSV file: numbers as a logger rounds them."""
    rows = np.column_stack(columns)
    return "\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n"


def _pulse(time: Array) -> Array:
    """15 g, 11 ms, half-sine, 0.2 s after the start [g]."""
    return np.where((time > 0.2) & (time < 0.211), 15.0 * np.sin(np.pi * (time - 0.2) / 0.011), 0.0)


def _transport(time: Array) -> Array:
    """A stretch of rough road of 1.4 g rms from 10 to 150 Hz, after a quiet part [g]."""
    band = scipy.signal.butter(2, (10.0, 150.0), "bandpass", fs=1.0 / (time[1] - time[0]), output="sos")
    envelope = np.clip((time - 2.0) / 0.4, 0.0, 1.0) * np.clip((time[-1] - 0.6 - time) / 0.4, 0.0, 1.0)
    shaken = scipy.signal.sosfiltfilt(band, _noise(time.size, 1.0, 7))
    return 1.4 * shaken / shaken.std() * envelope


def _drop(time: Array) -> Array:
    """A drop onto a pad: 50 g, 6 ms, with ringing of the table, and its second impact [g]."""
    first = np.where((time > 0.15) & (time < 0.156), 50.0 * np.sin(np.pi * (time - 0.15) / 0.006), 0.0)
    second = np.where((time > 0.45) & (time < 0.458), 12.0 * np.sin(np.pi * (time - 0.45) / 0.008), 0.0)
    since = np.maximum(time - 0.15, 0.0)
    return first + second + 4.0 * np.sin(2.0 * np.pi * 410.0 * since) * np.exp(-80.0 * since)


def _crash(time: Array) -> Array:
    """A terminal-peak sawtooth of 30 g and 25 ms [g]."""
    return np.where((time > 0.1) & (time < 0.125), 30.0 * (time - 0.1) / 0.025, 0.0)


# name, rate [Hz], length [s], course [g], rms of the noise [g]
_COURSES: tuple[tuple[str, float, float, Callable[[Array], Array], float], ...] = (
    ("half-sine", 5000.0, 0.5, _pulse, 0.02), ("road", 1000.0, 6.0, _transport, 0.005), ("drop", 10000.0, 0.7, _drop, 0.05),
    ("sawtooth", 5000.0, 0.5, _crash, 0.03),
)  # fmt: skip


def record_base(number: int, *, gravity: bool = False) -> Base:
    """Return a record in g along z; with `gravity` that of a DC-coupled sensor, which its baseline takes off."""
    name, rate, length, course, noise = _COURSES[number]
    time = np.arange(round(rate * length)) / rate
    z = course(time) + _noise(time.size, noise, 3 + number) + gravity
    ask = (lambda path: wr.load_record(path, baseline="rest")) if gravity else wr.load_record
    text = _table("time [s],z [g]", time, np.round(z, 4))
    return Base(f"{name}{' with gravity' * gravity}", {"record.csv": text}, "record.csv", ask)


RECORDS = tuple(record_base(number) for number in range(3))
SHOCKS = (RECORDS[0], RECORDS[2], record_base(3))
WITH_GRAVITY = tuple(record_base(number, gravity=True) for number in range(3))


def _loops_base(name: str, law: Law, amplitudes: tuple[float, ...], seed: int) -> Base:
    """Return a cyclic test of a law on a rig, in mm and N at 0.5 Hz, five cycles of each amplitude in one record."""
    x = [np.zeros(1)]
    phase = np.linspace(0.0, 2.0 * np.pi, 201)[1:]
    for amplitude in amplitudes:
        x += [amplitude * np.sin(phase)] * 5
    deflection = np.concatenate(x)
    force = law.trace(deflection).force
    force = force + _noise(force.size, 2e-3 * float(np.ptp(force)), seed)
    time = 0.01 * np.arange(deflection.size)
    text = _table("time [s],deflection [mm],force [N]", time, 1e3 * deflection, np.round(force, 2))
    return Base(name, {"test.csv": text}, "test.csv", ask_loops)


def ask_loops(path: Path) -> list[str]:
    return rig_warnings(read_tests([path]))[0]


def _loops() -> tuple[Base, ...]:
    wr16, socitec = wr.load_isolator("enidine_wr16_400"), wr.load_isolator("socitec_cb1400_30")
    wr12 = wr.load_isolator("enidine_wr12_400")
    return (
        _loops_base("WR16 shear", wr16.shear, (0.004, 0.012, 0.03), 11),
        _loops_base("CB1400 axial", socitec.axial, (0.002, 0.006, 0.012), 12),
        _loops_base("WR12 roll", wr12.roll, (0.002, 0.005, 0.01), 13),
    )


LOOPS = _loops()
WIDE_LOOPS = (
    LOOPS[1],
    _loops_base("CB1390 shear", wr.load_isolator("socitec_cb1390_30").shear, (0.002, 0.006, 0.012), 14),
    _loops_base("CB1400 shear", wr.load_isolator("socitec_cb1400_15").shear, (0.002, 0.006, 0.012), 15),
)


def _psd_base(name: str, points: Mapping[float, float]) -> Base:
    rows = "".join(f"{frequency:g},{level:g}\n" for frequency, level in points.items())
    levels = '[[motion]]\npsd = "psd.csv 30 s z seed 1"\n'
    files = {"psd.csv": f"frequency [Hz],psd [g^2/Hz]\n{rows}", "levels.toml": levels}
    return Base(name, files, "levels.toml", motion_of_levels)


DENSITIES = (
    _psd_base("workmanship", {20.0: 0.01, 80.0: 0.04, 350.0: 0.04, 2000.0: 0.007}),
    _psd_base("launcher", {20.0: 0.026, 50.0: 0.16, 800.0: 0.16, 2000.0: 0.026}),
    _psd_base("jet", {15.0: 0.1, 150.0: 0.1, 300.0: 0.3, 1000.0: 0.3, 2000.0: 0.075}),
)


def levels_base(name: str, key: str, phrase: str) -> Base:
    """Return a file of levels with one motion."""
    return Base(name, {"levels.toml": f'[[motion]]\n{key} = "{phrase}"\n'}, "levels.toml", motion_of_levels)


PULSES = (
    levels_base("half-sine 15 g", "half-sine", "15 g 11 ms z"),
    levels_base("sawtooth 40 g", "sawtooth", "40 g 11 ms x"),
    levels_base("trapezoid 30 g", "trapezoid", "30 g 18 ms y"),
)
SWEEPS = (
    levels_base("sweep 5 to 50 Hz", "sweep", "0.5 g 5 to 50 Hz 2 oct/min z"),
    levels_base("sweep 10 to 150 Hz", "sweep", "1 g 10 to 150 Hz 1 oct/min x"),
    levels_base("sweep 4 to 25 Hz", "sweep", "0.7 g 4 to 25 Hz 4 oct/min y"),
)
DOUBLE_PULSES = (
    levels_base("double pulse 50 mm", "double-pulse", "50 mm 3 m/s 100 g z"),
    levels_base("double pulse 43 mm", "double-pulse", "43 mm 2.5 m/s 60 g y"),
    levels_base("double pulse 20 mm", "double-pulse", "20 mm 1.2 m/s 30 g x"),
)


VELOCITIES = (
    levels_base("velocity step 2 m/s", "velocity-step", "2 m/s z"),
    levels_base("velocity step 3.5 m/s", "velocity-step", "3.5 m/s x"),
    levels_base("velocity step 1.2 m/s", "velocity-step", "1.2 m/s -y"),
)
DROPS = (
    levels_base("drop 300 mm", "drop", "300 mm onto bottom"),
    levels_base("drop 760 mm", "drop", "760 mm onto -x"),
    levels_base("drop 1200 mm", "drop", "1200 mm onto bottom -x"),
)


def _spectrum_base(name: str, points: Mapping[float, float], damping: str) -> Base:
    rows = "".join(f"{frequency:g},{level:g}\n" for frequency, level in points.items())
    levels = f'[[motion]]\nspectrum = "rrs.csv 10 s x damping {damping} seed 1"\n'
    files = {"rrs.csv": f"frequency [Hz],acceleration [g]\n{rows}", "levels.toml": levels}
    return Base(name, files, "levels.toml", motion_of_levels)


SPECTRA = (
    _spectrum_base("AC156", {1.3: 1.6, 8.3: 1.6, 33.3: 1.2, 50.0: 1.2}, "5 %"),
    _spectrum_base("floor", {1.0: 0.5, 3.0: 2.0, 8.0: 2.0, 30.0: 0.6, 40.0: 0.6}, "4 %"),
    _spectrum_base("zone 4", {0.5: 0.6, 1.0: 3.0, 2.0: 5.0, 5.0: 5.0, 10.0: 2.0, 33.0: 2.0}, "5 %"),
)


def _job_base(model: str, motion: str, limits: str, deck: str) -> Base:
    case = f'[[case]]\nname = "vertical shock"\n{motion}\nduration = 0.5\n\n'
    other = '[[case]]\nname = "measured"\nrecord = "record.csv"\nbaseline = "rest"\nduration = 0.5\n\n'
    head = f'name = "A job"\nmodel = "{model}"\ndeck = "{deck}"\n\n'
    files = {"job.toml": f"{head}{case}{other}[limits]\n{limits}\n", "record.csv": WITH_GRAVITY[0].files["record.csv"]}
    return Base(f"job on {model}", files, "job.toml", wr.load_job)


JOBS = (
    _job_base(
        "shock_table", 'half-sine = "15 g 11 ms z at 50 ms"',
        '"acceleration/block" = "20 g"\n"clearance/block_top" = "30 30 40 mm"\n"load/m1" = "5 kN"', "25 Hz 300 kg 4 %",
    ),
    _job_base(
        "cabinet", 'double-pulse = "43 mm 2.5 m/s 60 g z at 50 ms"',
        '"acceleration/rack" = "15 g"\n"clearance/rack_top" = "60 60 60 mm"\n"load/m01" = "8 kN"', "10 Hz 800 kg 4 %",
    ),
    _job_base(
        "floating_floor", 'sawtooth = "10 g 18 ms z at 50 ms"',
        '"acceleration/floor" = "10 g"\n"clearance/rack_1_top" = "60 60 60 mm"\n"load/m01" = "20 kN"', "8 Hz 4000 kg 3 %",
    ),
)  # fmt: skip


def _study_base(model: str, lines: str) -> Base:
    def ask(path: Path) -> object:
        vary = read_vary(path.read_text(encoding="utf-8").splitlines())
        motion = wr.HalfSine(peak=150.0, duration=0.011, direction="z")
        return wr.Study(model=model, motion=motion, duration=0.1, vary=vary, variants=64, timestep=1e-4).table()

    return Base(f"study of {model}", {"vary.txt": lines}, "vary.txt", ask)


_FACTOR, _EACH = "Normal(1, 0.1, relative)", "Normal(1, 0.08, relative, each)"
STUDIES = (
    _study_base("shock_table", f"mount/m1/axial/stiffness = {_FACTOR}\nbody/block/mass = {_FACTOR}"),
    _study_base("cabinet", f"mount/m*/axial/stiffness = {_EACH}\nbody/rack/mass = {_FACTOR}"),
    _study_base("floating_floor", f"mount/m*/shear/stiffness = {_FACTOR}\nbody/floor/mass = {_FACTOR}"),
)
