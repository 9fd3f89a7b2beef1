"""Laws of several scales identified from loops of devices of 3 to 40 sliders, beside the devices themselves.

    python tests/slider_devices.py --sliders 3 5 10 20 40

Each is fitted to noisy loops of 0.5 to 15 mm. The least amplitude is left out and predicted, by one set and by several; a mass
on either shows resonances and transmissibilities, and cycles of a fifth of the least amplitude frequency and damping there.
"""

import argparse
import math
from dataclasses import replace

import numpy as np
from house import sdof

import wirerope_mj as wr
from wirerope_mj.mounts.identification.identify import group_error
from wirerope_mj.mounts.identification.measured import prepare

MASS = 50.0
AMPLITUDES = (0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 15e-3)
LEVELS = (0.005, 0.02, 0.1)  # [g]
SMALL = 0.1e-3


def device(sliders, least, *, c=8.0):
    """Return sliders in parallel that yield from half the largest amplitude down to `least` [m], asymmetric, and one spring."""
    slips = np.geomspace(0.5 * AMPLITUDES[-1], least, sliders)
    shares = slips**0.6 / (slips**0.6).sum()
    springs = [{"k1": 3e4, "k2": 0.0, "k3": 3e7}] + [{"k1": 0.0, "k2": 0.0, "k3": 0.0}] * (sliders - 1)
    return wr.Parallel(
        laws=[
            wr.AsymmetricBoucWen.from_normalised(z_max=510.0 * share, x_y=slip, sigma=0.6, n=2.0, b=math.e, c=c, **spring)
            for slip, share, spring in zip(slips, shares, springs, strict=True)
        ]
    )


def noisy_loops(law, *, noise=2e-3, seed=0):
    """Return steady loops with noise of a fraction of half the force range."""
    rng, loops = np.random.default_rng(seed), []
    for loop in wr.cyclic_test(law, AMPLITUDES, points_per_cycle=200):
        force = loop.force + noise * 0.5 * np.ptp(loop.force) * rng.standard_normal(loop.force.size)
        force[-1] = force[0]
        loops.append(replace(loop, force=force))
    return loops


def resonance(law, level_g):
    """Return frequency [Hz] and transmissibility of a mass at its peak."""
    shake = {"acceleration": level_g * wr.STANDARD_GRAVITY, "direction": "z", "payload": "mass"}
    branch = wr.follow_branch(sdof(law, mass=MASS), start=5.0, stop=40.0, **shake)
    peak = max(wr.resonances(branch), key=lambda one: one.amplitude)
    return np.array([peak.frequency, peak.amplitude / branch.acceleration[0]])


def main():
    """Print a row for each device."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--sliders", nargs="+", type=int, default=[3, 5, 10, 20, 40])
    parser.add_argument("--least", type=float, default=0.5 * AMPLITUDES[0], help="yield deflection of the least slider [m]")
    parser.add_argument("--scales", type=int, default=3)
    asked = parser.parse_args()
    print(
        "sliders | left out, one set and several | n | resonance, transmissibility at three levels | "
        "frequency, damping of small cycles, one set and several"
    )
    for sliders in asked.sliders:
        true = device(sliders, asked.least)
        loops = noisy_loops(true)
        found = {
            (scales, first): wr.identify(loops[first:], law=wr.AsymmetricBoucWen, scales=scales, profiles=False).law
            for scales, first in ((1, 1), (asked.scales, 1), (asked.scales, 0))
        }
        one, several = (group_error(found[scales, 1], prepare(loops)[:1], [0]) for scales in (1, asked.scales))
        law = found[asked.scales, 0]
        peaks = np.array([resonance(law, level) / resonance(true, level) - 1.0 for level in LEVELS])
        small = {}
        for scales in (1, asked.scales):
            one = law if scales > 1 else wr.identify(loops, law=wr.AsymmetricBoucWen, profiles=False).law
            ours, theirs = (wr.cyclic_test(each, [SMALL], points_per_cycle=200)[0] for each in (one, true))
            frequency = math.sqrt(ours.secant_stiffness / theirs.secant_stiffness) - 1.0
            small[scales] = f"{frequency:+.1%} {ours.damping_ratio / theirs.damping_ratio - 1.0:+.0%}"
        shown = "; ".join(f"{f:+.1%} {t:+.1%}" for f, t in peaks)
        exponents = ", ".join(f"{part.n:.2f}" for part in law.components)
        left = f"{one:.2e} {several:.2e}, {several / one:.2f} of it"
        print(f"{sliders} | {left} | {exponents} | {shown} | {'; '.join(small.values())}", flush=True)


if __name__ == "__main__":
    main()
