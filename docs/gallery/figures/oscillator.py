"""One mass on one isolator: its periodic motions over frequency, sweeps, and what is read off them."""

from functools import cache

import numpy as np
import numpy.typing as npt

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic import harmonic_content
from wirerope_mj.mounts.laws import Law

Array = npt.NDArray[np.float64]

RATE = 2.0
"""Octaves per minute: the thesis' factor of four in frequency every minute."""

BESIDE = 0.004
"""Distance of the motions around a peak from it, as a share of the frequency: a fifth of the narrowest half width."""

_MODEL = """\
<mujoco>
  <option gravity="0 0 {gravity}"/>
  <default><geom contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="table">
      <joint name="table_z" type="slide" axis="0 0 1"/><geom size="0.1" mass="10"/><site name="below" pos="0 0 0.1"/>
    </body>
    <body name="mass" pos="0 0 0.2">
      <joint name="mass_z" type="slide" axis="0 0 1"/><geom size="0.05" mass="{mass}"/><site name="above" pos="0 0 -0.1"/>
    </body>
  </worldbody>
  <custom>
    <text name="isolator/one" data="one.toml"/>
    <tuple name="mount/m1">
      <element objtype="site" objname="above"/>
      <element objtype="site" objname="below"/>
      <element objtype="text" objname="isolator/one"/>
    </tuple>
  </custom>
</mujoco>"""


@cache
def oscillator(law: Law, *, mass: float, gravity: float = 0.0) -> wr.System:
    """Return a mass that is guided along z, on one isolator with `law` on a table."""
    text = _MODEL.format(gravity=-gravity, mass=mass)
    return wr.load_system(text, isolators={"one": wr.Isolator(name="one", axial=law)})


@cache
def branch(system: wr.System, start: float, stop: float, level: float) -> wr.Branch:
    """Return the periodic motions between two frequencies [Hz] at a base acceleration [m/s^2], as exact as a picture is."""
    return wr.follow_branch(
        system, start=start, stop=stop, acceleration=level, direction="z", payload="mass", accuracy=1e-3, tolerance=1e-4,
        largest_step=0.05,
    )  # fmt: skip


def resonance(found: wr.Branch, *, fundamental: bool = False) -> tuple[float, float]:
    """Return frequency [Hz] and amplitude [m/s^2] of a branch's peak, from three motions around it that are solved anew.

    The amplitude is the largest acceleration, or its part at the base's frequency.
    """
    guess, amplitudes = found.orbit(found.peak).state, []
    frequencies = round(float(found.frequency[found.peak]), 2) * np.array([1.0 - BESIDE, 1.0, 1.0 + BESIDE])
    for frequency in frequencies:
        orbit = wr.periodic_orbit(
            found.system, frequency=frequency, acceleration=float(found.acceleration[0]), direction="z", guess=guess
        )
        peaks = orbit.response.peaks.bodies["mass"].acceleration
        whole = max(peaks.maximum[2], -peaks.minimum[2])
        amplitudes.append(wr.harmonic_content(orbit, payload="mass").of(1) if fundamental else whole)
    return peak(frequencies, np.array(amplitudes), middle=1)


@cache
def swept(system: wr.System, start: float, stop: float, level: float, *, timestep: float) -> wr.FrequencySweep:
    """Return the envelope of a sweep at two octaves per minute that begins at rest, as the thesis' do."""
    sweep = wr.Sweep(start=start, stop=stop, rate=RATE, acceleration=level, direction="z")
    return wr.frequency_sweep(system, sweep, payload="mass", settled=None, timestep=timestep)


def peak(frequency: Array, amplitude: Array, middle: int | None = None) -> tuple[float, float]:
    """Return the highest point [Hz, m/s^2], by the parabola through `middle`, or the highest sample, and its neighbours."""
    i = int(np.argmax(amplitude)) if middle is None else middle
    x, y = np.log(frequency[i - 1 : i + 2] / frequency[i]), amplitude[i - 1 : i + 2] - amplitude[i]
    left, right = y[0] / x[0], y[2] / x[2]
    bend = (left - right) / (x[0] - x[2])
    slope = left - bend * x[0]
    return float(frequency[i] * np.exp(-slope / (2.0 * bend))), float(amplitude[i] - slope**2 / (4.0 * bend))


def harmonics(orbit: wr.PeriodicOrbit, number: int) -> Array:
    """Return the amplitudes of harmonics 1 to `number` of the mass' absolute acceleration [m/s^2]."""
    return harmonic_content(orbit, payload="mass", highest=number).amplitude[1:]
