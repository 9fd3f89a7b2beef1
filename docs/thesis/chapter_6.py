"""Chapter 6: sweeps of the shaker up and down, superharmonics by order, and a shock on a table and on a frame."""

from collections.abc import Callable
from functools import cache

import numpy as np
from figures.drawing import COLOURS, GUIDE, INK, canvas, explain, inscribe
from figures.oscillator import Array, branch, harmonics, peak, resonance
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from wirerope_mj.runs.scenario import load_scenario

G = wr.STANDARD_GRAVITY
LEVELS = (0.25, 0.5, 1.0)  # [g]
RANGE, STEP = (26.0, 46.0), 4e-4  # [Hz], [s] of the sweeps
NEAR = {2: (15.5, 21.0), 3: (11.0, 13.5)}  # [Hz]
ORDER_LEVEL = 0.5 * G
ORDER_LEVELS = {"weak": 0.1, "half": 0.5}  # [g]
FRAME = 40.0  # [Hz]


@cache
def shaker() -> wr.System:
    """Return the shipped rig: 3.5 kg on one isolator."""
    return wr.load_system("sdof_shaker")


@cache
def sweep(level: float, up: bool) -> wr.FrequencySweep:
    """Return the envelope of a sweep at two octaves per minute."""
    start, stop = RANGE if up else RANGE[::-1]
    motion = wr.Sweep(start=start, stop=stop, rate=2.0, acceleration=level * G, direction="z")
    return wr.frequency_sweep(shaker(), motion, payload="mass", timestep=STEP)


@cache
def order(number: int, level: float = 0.5) -> tuple[Array, Array]:
    """Return frequencies [Hz] and amplitudes [m/s^2] of one harmonic of the mass' acceleration at a level [g]."""
    found = branch(shaker(), *NEAR[number], level * G)
    return found.frequency, np.array([harmonics(found.orbit(i), number)[-1] for i in range(found.frequency.size)])


@cache
def shock(frame: bool) -> wr.Response:
    """Return the half-sine of 20 g and 11 ms on 50 kg on one mount, with and without a frame below it."""
    made = load_scenario("shock_table_frame").make(frame_hz=FRAME) if frame else load_scenario("shock_table").make()
    system = wr.load_system(made.model_source())
    return wr.simulate(system, made.motion, duration=0.4, accuracy=1e-3, sample_rate=5000.0)


def ringing() -> float:
    """Return the frequency [Hz] at which the two accelerometers, on frame and table, differ most after the pulse."""
    run = shock(True)
    after = run.time > 0.075
    apart = (run.bodies["frame"].acceleration[:, 2] - run.base.acceleration[:, 2])[after]
    spectrum = np.abs(np.fft.rfft((apart - apart.mean()) * np.hanning(apart.size), 1 << 16))
    frequency = np.fft.rfftfreq(1 << 16, 1.0 / 5000.0)
    beyond = frequency > 15.0  # above what the payload does on its mount
    return float(frequency[beyond][np.argmax(spectrum[beyond])])


def numbers() -> dict[str, float]:
    """Return resonances by sweeps and by shooting, orders, and peaks of the shock."""
    found: dict[str, float] = {}
    for place, level in enumerate(LEVELS, 1):
        frequency, amplitude = resonance(branch(shaker(), *RANGE, level * G))
        found |= {f"f{place}": frequency, f"t{place}": amplitude / (level * G)}
        for way in (True, False):
            envelope = sweep(level, way)
            found[f"{'up' if way else 'down'}{place}"] = peak(envelope.frequency, envelope.amplitude)[0]
    for name, level in ORDER_LEVELS.items():
        top = resonance(branch(shaker(), *RANGE, level * G))[0]
        found[f"{name}_top"] = top
        for number, thesis in ((2, 36.2 / 18.2), (3, 36.2 / 12.2)):
            at, height = peak(*order(number, level))
            found |= {f"{name}_{number}": at, f"{name}_height_{number}": height, f"{name}_ratio_{number}": top / at}
            found[f"{name}_apart_{number}"] = 100.0 * (top / at / thesis - 1.0)
            found[f"{name}_place_{number}"] = 100.0 * (at * thesis / 36.2 - 1.0)
    for name, run in (("frame", shock(True)), ("rigid", shock(False))):
        found[f"block_{name}"] = run.peaks.bodies["block"].acceleration.value / G
    found["frame_peak"] = shock(True).peaks.bodies["frame"].acceleration.value / G
    found["table_peak"] = float(np.abs(shock(True).base.acceleration[:, 2]).max()) / G
    return found | {"given": FRAME, "ringing": ringing(), "thesis_2": 36.2 / 18.2, "thesis_3": 36.2 / 12.2}


def pictures() -> dict[str, Callable[[], Picture]]:
    """Return what draws the sweeps and the shock."""
    return {"chapter_6_sweeps": _draw_sweeps, "chapter_6_shock": _draw_shock}


def _draw_sweeps() -> Picture:
    picture, (sweeps, orders) = canvas(2, height=3.9)
    for panel in (sweeps, orders):
        for line in panel.lines[:2]:
            line.remove()
    for level, colour in zip(LEVELS, COLOURS, strict=False):
        motions = branch(shaker(), *RANGE, level * G)
        sweeps.plot(motions.frequency, motions.transmissibility, color=colour, lw=3.0, alpha=0.6, label=f"{level:g} g")
        for way, style in ((True, "-"), (False, "--")):
            envelope = sweep(level, way)
            sweeps.plot(envelope.frequency, envelope.amplitude / (level * G), style, color=INK, lw=0.7)
    sweeps.plot([], [], color=INK, lw=0.7, label="sweep up (dashed: down)")
    sweeps.set_xlim(*RANGE)
    for number, colour in zip(NEAR, COLOURS[1:], strict=False):
        orders.plot(*order(number), color=colour, lw=1.6, label=f"harmonic {number}")
    for thesis in (18.2, 12.2):
        orders.axvline(thesis, color=GUIDE, lw=0.9, ls="--")
    inscribe(sweeps, "shipped shaker", "frequency [Hz]", "transmissibility [-]")
    inscribe(orders, "0.5 g; dashed: the thesis' 12.2 and 18.2 Hz", "frequency [Hz]", "amplitude [m/s²]")
    orders.set_xlim(10.0, 22.0)
    explain(sweeps, place="below", columns=2)
    explain(orders, place="below", columns=2)
    return picture


def _draw_shock() -> Picture:
    picture, (panel,) = canvas(1, height=3.6)
    run, rigid = shock(True), shock(False)
    time = 1e3 * (run.time - 0.05)
    panel.plot(time, run.bodies["frame"].acceleration[:, 2] / G, color=COLOURS[1], lw=1.0, label=f"frame, {FRAME:g} Hz")
    panel.plot(time, run.base.acceleration[:, 2] / G, color=GUIDE, lw=1.6, label="table")
    panel.plot(time, run.bodies["block"].acceleration[:, 2] / G, color=COLOURS[0], lw=1.8, label="mass")
    panel.plot(1e3 * (rigid.time - 0.05), rigid.bodies["block"].acceleration[:, 2] / G, "--", color=INK, lw=1.0,
               label="mass, no frame")  # fmt: skip
    panel.set_xlim(-10.0, 200.0)
    inscribe(panel, "half-sine, 20 g, 11 ms", "time [ms]", "acceleration [g]")
    explain(panel, place="upper right")
    return picture
