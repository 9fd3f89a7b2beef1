"""Branches and multipliers of one mass over the exponent, the law and the level, beside settled simulations and fine steps.

python tests/steep_branches.py branches
python tests/steep_branches.py multipliers
"""

import argparse
import itertools
from dataclasses import replace

import numpy as np
from house import sdof

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic.motion import Drive
from wirerope_mj.dynamics.periodic.orbit import OrbitSearch
from wirerope_mj.dynamics.periodic.shooting import shot
from wirerope_mj.dynamics.periodic.variational import variational_of
from wirerope_mj.foundation.units import STANDARD_GRAVITY

MASS = 3.5
Z_MAX, YIELD, ELASTIC = 240.0, 1e-3, 34e3

EXPONENTS = (0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 1.0, 2.0)
LEVELS = (0.02, 0.2, 1.0)  # [g]
CYCLES, STEPS = 300, 2000  # of a simulation that is left to itself at the peak, and its steps in a cycle


def bouc_wen(n, share=1.0):
    """Return a law that yields at a millimetre with `share` of the friction force."""
    return wr.BoucWen.from_normalised(z_max=share * Z_MAX, x_y=share * YIELD, sigma=0.5, n=n, k=ELASTIC)


def asymmetric(n):
    return wr.AsymmetricBoucWen.from_normalised(
        z_max=Z_MAX, x_y=YIELD, sigma=0.5, n=n, k1=ELASTIC, k2=-2e5, k3=3e8, b=np.e, c=20.0
    )


def two_scales():
    return wr.Parallel(laws=[bouc_wen(0.2), asymmetric(0.4)])


def motion_of(search, frequency, level_g, steps):
    """Return what is left after 150 periods, which forgets all but 1e-3 of a start at rest."""
    drive = Drive(frequency=frequency, acceleration=level_g * STANDARD_GRAVITY, periods=1, steps=steps)
    return shot(search.flow, search.settled(search.coordinates.rest(), drive, 150), drive)


def search_of(law):
    return OrbitSearch(sdof(law, mass=MASS), direction="z", history="relaxed", accuracy=1e-4)


def moduli(matrix):
    return np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1]


GRID = tuple(itertools.product((bouc_wen, asymmetric), EXPONENTS, LEVELS))


def branches():
    """Follow each branch, and leave the motion at its peak to itself."""
    flagged, gaps, worst = 0, 0, 0.0
    for law, n, level in GRID:
        shake = {"acceleration": level * STANDARD_GRAVITY, "direction": "z", "payload": "mass"}
        branch = wr.follow_branch(sdof(law(n), mass=MASS), start=10.0, stop=45.0, **shake)
        peak = branch.orbit(branch.peak)
        left = wr.simulate(
            branch.system, peak.motion, duration=CYCLES / peak.frequency, initial=peak.state,
            timestep=1.0 / (STEPS * peak.frequency), sample_rate=200.0 * peak.frequency,
        )  # fmt: skip
        last = np.abs(left.bodies["mass"].acceleration[-2000:, 2]).max()
        unstable, off = int((~branch.stable).sum()), float(branch.amplitude[branch.peak] / last - 1.0)
        flagged, gaps, worst = flagged + unstable, gaps + len(branch.gaps), max(worst, abs(off))
        print(
            f"{law.__name__} n {n:g} {level:g} g: {unstable}/{branch.stable.size} flagged, {len(branch.gaps)} gaps, "
            f"{len(branch.bifurcations)} events, peak {off:+.1e}{'' if branch.complete else ' ' + branch.message}", flush=True,
        )  # fmt: skip
    print(f"{len(GRID)} branches: {flagged} points flagged, {gaps} gaps, peaks within {worst:.1e}")


def multipliers():
    """Compare multipliers at 1000 steps a period with those at 64 000."""
    worst = 0.0
    for law, n, level in GRID:
        search = search_of(law(n))
        with search.flow.ready():
            coarse = motion_of(search, 20.0, level, 1000)
            drive = replace(coarse.track.drive, steps=64_000)
            fine = shot(search.flow, search.settled(coarse.x, drive, 30), drive)
            few, many = (moduli(variational_of(search.flow).matrix(motion)) for motion in (coarse, fine))
        worst = max(worst, float(np.abs(few - many).max()))
        print(f"{law.__name__} n {n:g} {level:g} g: {many[0]:.4f}, off by {np.abs(few - many).max():.1e}", flush=True)
    print(f"{len(GRID)} motions: multipliers within {worst:.1e}")


def main():
    """Run one of both."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=["branches", "multipliers"])
    {"branches": branches, "multipliers": multipliers}[parser.parse_args().what]()


if __name__ == "__main__":
    main()
