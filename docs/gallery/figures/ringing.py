"""Figure 3.17: the response to a steady 10 Hz for a small and a large exponent, and why the large one rings."""

from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import COLOURS, GUIDE, canvas, explain, inscribe, note
from figures.figure import Figure
from figures.resonance import EXPONENTS, LEVEL, UNIT, Case

Array = npt.NDArray[np.float64]

SMALL, LARGE = Case(name="small", label="n = 0.1", n=0.1), Case(name="large", label="n = 10", n=10.0)
FREQUENCY, BESIDE = 10.0, 9.5  # [Hz]
OWN = UNIT**0.5 / (2.0 * np.pi)  # [Hz]: of 1 kg on 1 kN/m
END = 22.0  # [s]
STEP = 1e-3  # [s]
DOWN = (30.0, 7.0)  # [Hz] of a sweep that does not pass the resonance
BAND = 0.1  # [Hz]: what belongs to one place of its envelope
AMPLITUDES = np.geomspace(1e-3, 1.0, 50)  # [m]


def figures() -> list[Figure]:
    """Return figure 3.17."""
    n = measure()
    return [
        Figure(
            number="3.17",
            title="Response to a steady 10 Hz for n = 0.1 and n = 10",
            section="3.3.2",
            statement="For large n the steady response to 10 Hz holds a subharmonic, perhaps because the system behaves more "
            "like an elasto-plastic one. There are no subharmonics otherwise.",
            shown=f"After {END:.0f} s from rest the mass on n = 10 moves with {n['large_forced']:.2f} m/s² at 10 Hz and "
            f"{n['large_own']:.2f} m/s² at {OWN:.2f} Hz, near enough half of 10 Hz to look like a subharmonic of it. On n = "
            "0.1 less than 0.001 m/s² is left of that. It is the free oscillation that switching on left: a linear mass "
            f"would keep {n['linear']:.2f} m/s², and n = 10 is a linear spring far below its bound. Per period of the "
            f"excitation a disturbance is multiplied by {n['small_multiplier']:.2f} for n = 0.1 and by 1 within "
            f"1e-5 for n = 10. Excited with {BESIDE:g} Hz, the mass rings at {n['beside_own_frequency']:.2f} "
            f"Hz all the same ({n['beside_own']:.2f} m/s²): it is not locked to the excitation, as a subharmonic would be. "
            f"What may be taken for a peak: in a sweep down from {DOWN[0]:g} Hz the beat of the two motions makes the envelope "
            f"ragged, by {100 * n['ragged_beside']:.0f} % within {BAND:g} Hz of {BESIDE:g} Hz; at {2 * OWN:.2f} Hz, twice the "
            f"own frequency, the beat stands still and it is smooth ({100 * n['ragged_twice']:.0f} %). A free oscillation of "
            "amplitude A loses the share 8βαⁿ⁻¹Aⁿ/(n+2) of its energy in a cycle: at 10 mm "
            f"{100 * n['loss_half']:.0f} % for n = 0.5, {100 * n['loss_one']:.1f} % for n = 1, nothing for n = 10.",
            parameters="As figure 3.16, with n = 0.1 and n = 10 as in the thesis.",
            numbers=n,
            draw=_draw,
        )
    ]


@cache
def history(case: Case, frequency: float) -> tuple[Array, Array]:
    """Return time [s] and acceleration of the mass [m/s^2] from rest under a steady sine."""
    sine = wr.Sine(frequency=frequency, acceleration=LEVEL, direction="z")
    response = wr.simulate(case.system, sine, duration=END, timestep=STEP, sample_rate=500.0)
    return response.time, response.bodies["mass"].acceleration[:, 2]


def parts(time: Array, acceleration: Array, frequencies: tuple[float, ...]) -> list[float]:
    """Return the amplitudes of sines of given frequencies in the second half of a history, by least squares."""
    late = time >= END / 2.0
    phase = 2.0 * np.pi * np.outer(time[late], frequencies)
    fitted = np.linalg.lstsq(np.hstack([np.cos(phase), np.sin(phase)]), acceleration[late], rcond=None)[0]
    return [float(value) for value in np.hypot(*fitted.reshape(2, -1))]


def spectrum(time: Array, acceleration: Array) -> tuple[Array, Array]:
    """Return frequencies [Hz] and amplitudes [m/s^2] of the second half of a history, through Kaiser's window."""
    late = time >= END / 2.0
    samples, window = acceleration[late], np.kaiser(np.count_nonzero(late), 14.0)
    size = 8 * samples.size  # finer than the resolution, so that peaks are drawn as high as they are
    amplitude = 2.0 * np.abs(np.fft.rfft(samples * window, size)) / window.sum()
    return np.fft.rfftfreq(size, time[1] - time[0]), amplitude


@cache
def envelope() -> tuple[Array, Array]:
    """Return frequency [Hz] and largest acceleration [m/s^2] of the cycles of the sweep down."""
    sweep = LARGE.sweep(DOWN)
    return sweep.frequency, sweep.amplitude


def ragged(frequency: float) -> float:
    """Return by what share of its mean the envelope varies near a frequency [Hz]."""
    places, amplitude = envelope()
    near = amplitude[np.abs(places - frequency) < BAND]
    return float(np.ptp(near) / near.mean())


def loss(case: Case, amplitude: Array) -> Array:
    """Return the share of its energy that a free oscillation loses in a cycle, for small amplitudes [m]."""
    return np.asarray(8.0 * case.beta * case.alpha ** (case.n - 1.0) * amplitude**case.n / (case.n + 2.0))


def measure() -> dict[str, float]:
    """Return amplitudes at the excitation's frequency and at the mass' own, and Floquet multipliers."""
    numbers = {}
    for case in (SMALL, LARGE):
        forced, own = parts(*history(case, FREQUENCY), (FREQUENCY, OWN))
        numbers |= {f"{case.name}_forced": forced, f"{case.name}_own": own}
        orbit = wr.periodic_orbit(case.system, frequency=FREQUENCY, acceleration=LEVEL, direction="z")
        numbers[f"{case.name}_multiplier"] = float(np.abs(orbit.floquet_multipliers).max())
    beside = history(LARGE, BESIDE)
    frequency, amplitude = spectrum(*beside)
    low = frequency < 0.75 * BESIDE
    ratio = FREQUENCY / OWN
    return numbers | {
        "linear": LEVEL * ratio / (ratio**2 - 1.0),
        "ragged_twice": ragged(2.0 * OWN),
        "ragged_beside": ragged(BESIDE),
        "loss_half": float(loss(EXPONENTS[0], np.array(0.01))),
        "loss_one": float(loss(EXPONENTS[1], np.array(0.01))),
        "beside_own": parts(*beside, (BESIDE, OWN))[1],
        "beside_own_frequency": float(frequency[low][np.argmax(amplitude[low])]),
    }


def _draw() -> Picture:
    picture, (over_time, lines, down, decay) = canvas(2, rows=2, height=3.3)
    lines.lines[0].remove()  # a logarithmic axis has no zero
    over_time.lines[1].remove()
    for line in down.lines[:2] + decay.lines[:2]:
        line.remove()
    for case, colour in ((SMALL, COLOURS[0]), (LARGE, COLOURS[1])):
        time, acceleration = history(case, FREQUENCY)
        last = time >= END - 1.0
        over_time.plot(time[last], acceleration[last], color=colour, lw=1.6, label=case.label)
        lines.plot(*spectrum(time, acceleration), color=colour, lw=1.4, label=f"{case.label}, 10 Hz")
    lines.plot(*spectrum(*history(LARGE, BESIDE)), ":", color=COLOURS[3], lw=1.4, label=f"n = 10, {BESIDE:g} Hz")
    over_time.plot(time[last], LEVEL * np.sin(2.0 * np.pi * FREQUENCY * time[last]), color=GUIDE, lw=0.9, label="ground")
    over_time.set_xlim(END - 1.0, END)
    over_time.set_ylim(-13.0, 17.0)
    lines.set_yscale("log")
    lines.set_xlim(0.0, 35.0)
    lines.set_ylim(1e-3, 30.0)
    inscribe(over_time, "from rest, 10 Hz", "time [s]", "acceleration [m/s²]")
    inscribe(lines, f"spectrum of the last {END / 2:.0f} s", "frequency [Hz]", "amplitude [m/s²]")
    explain(over_time, columns=3, place="upper center")
    explain(lines, place="upper right")
    _draw_envelope(down)
    _draw_loss(decay)
    return picture


def _draw_envelope(panel: Any) -> None:
    frequency, amplitude = envelope()
    ratio = frequency / OWN
    panel.plot(frequency, amplitude, color=COLOURS[1], lw=0.8, label="n = 10, sweep down")
    panel.plot(frequency, LEVEL / (ratio**2 - 1.0), color=COLOURS[0], lw=1.4, label="periodic motion")
    for order in (2, 3, 4):
        panel.axvline(order * OWN, color=GUIDE, lw=0.9, ls="--")
        note(panel, f"{order} f₀", (order * OWN, 5.6), ha="center", colour=GUIDE)
    panel.set_xlim(8.0, 22.0)
    panel.set_ylim(0.0, 8.0)
    inscribe(panel, "largest acceleration of each cycle", "frequency [Hz]", "acceleration [m/s²]")
    explain(panel, place="upper right")


def _draw_loss(panel: Any) -> None:
    for case, colour in zip(EXPONENTS, (COLOURS[0], COLOURS[2], COLOURS[3], COLOURS[1]), strict=True):
        panel.plot(AMPLITUDES, loss(case, AMPLITUDES), color=colour, lw=1.6, label=case.label)
    panel.set_xlim(AMPLITUDES[0], AMPLITUDES[-1])
    panel.set_ylim(1e-6, 10.0)
    panel.set_xscale("log")
    panel.set_yscale("log")
    inscribe(panel, "energy lost in a free cycle, small amplitudes", "amplitude [m]", "share [-]")
    explain(panel, place="lower right")
