"""Make the isolator of five twin specimens anew: python docs/specimens/build.py.

The thesis tested five nominally equal springs; their records are not published. So five mounts are made up here, tested in
the virtual rig, and identified as measured ones would be. Nothing of it is a measurement.
"""

from pathlib import Path

import numpy as np

import wirerope_mj as wr
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.identification import SpecimenFits, identify_specimens, joint_spread
from wirerope_mj.mounts.isolator import Provenance
from wirerope_mj.mounts.test_rig import cyclic_test, measured

ORIGIN = "enidine_wr16_400"
ORIGIN_FILE = Path(__file__).parents[2] / "tests" / "data" / "one_scale" / f"{ORIGIN}.toml"
"""The catalogue's file of 0.2.0, with one scale of friction, of which the twins were made."""
SPECIMENS = 5
SIZE, ROPE, FRICTION = 0.011, 0.03, 0.05
"""Standard deviations, as shares: of the loops' size, of the rope's bending stiffness, of its friction."""
NOISE = 0.002
"""Standard deviation of the measured force, of its half range: a good load cell and amplifier."""
SHARES = (0.05, 0.2, 0.6, 1.0)
"""Amplitudes of the quasi-static tests, of the rated travel."""
SHARED = {"axial": ("n", "sigma", "k2", "k3"), "shear": ("n", "sigma", "k2"), "roll": ("n", "sigma", "k2")}
"""Shape of the loops, which does not scatter here: found from all specimens together."""


def main() -> None:
    """Write the isolator's file beside the catalogue and print what was found."""
    path = catalogue_folder() / "twins" / "five_twins_wr16_400.toml"
    isolator, found = identified()
    isolator.save(path)
    for axis, specimens in found.items():
        print(f"{axis}\n{specimens}")
    print(f"written: {path}")


def identified() -> tuple[wr.Isolator, dict[str, SpecimenFits]]:
    """Return the isolator with its spread, and what was found on every axis."""
    origin = wr.load_isolator(ORIGIN_FILE)
    twins = made(origin, scatter())
    found = {axis: _found(axis, origin, [twin.axes[axis] for twin in twins]) for axis in SHARED}
    isolator = wr.Isolator(
        name="Twin of Enidine WR16-400, five specimens",
        **{axis: specimens.law for axis, specimens in found.items()},
        limits=origin.limits,
        geometry=origin.geometry,
        provenance=_provenance(),
        spread=joint_spread(found),
    )
    return isolator, found


def scatter() -> np.ndarray:
    """Return size, bending stiffness and friction of every specimen, relative to the nominal one, (n, 3)."""
    return 1.0 + np.random.default_rng(2004).standard_normal((SPECIMENS, 3)) * [SIZE, ROPE, FRICTION]


def made(origin: wr.Isolator, relative: np.ndarray) -> list[wr.Isolator]:
    """Return isolators like `origin` of other size, stiffness and friction.

    Loops of rope bend like rods that do not stretch: of a loop s times as large, all deflections are s times and all forces
    1/s^2 times as large (of one bending stiffness): F(x) = F_0(x / s) / s^2.
    """
    return [_scaled(origin, *(float(one) for one in row)) for row in relative]


def _scaled(origin: wr.Isolator, size: float, rope: float, friction: float) -> wr.Isolator:
    force = rope / size**2
    laws = {}
    for axis in SHARED:
        law = origin.axes[axis]
        old = law.normalised
        elastic = {f"k{power}": force / size**power * getattr(law, f"k{power}") for power in (1, 2, 3)}
        bend = {"c": law.c / size, "b": law.b} if axis == "axial" else {}
        laws[axis] = type(law).from_normalised(
            z_max=force * friction * old.z_max, x_y=size * old.x_y, sigma=old.sigma, n=old.n, **elastic, **bend
        )
    return wr.Isolator(name=origin.name, **laws)


def _found(axis: str, origin: wr.Isolator, laws: list) -> SpecimenFits:
    travel = origin.limits.travel
    rated = {"axial": travel.compression, "shear": travel.shear, "roll": travel.roll}[axis]
    tests = []
    for number, law in enumerate(laws):
        loops = cyclic_test(law, [share * rated for share in SHARES])
        seeds = 1000 * list(SHARED).index(axis) + 10 * number
        tests.append(
            [
                measured([loop], points_per_cycle=200, force_noise=NOISE * np.ptp(loop.force) / 2.0, seed=seeds + place)[0]
                for place, loop in enumerate(loops)
            ]
        )
    return identify_specimens(tests, law=type(laws[0]), shared=SHARED[axis])


def _provenance() -> Provenance:
    return Provenance(
        kind="illustrative",
        source="five twin specimens, simulated: no mount was measured. docs/specimens/build.py makes them and this file",
        fitted_to=(
            f"virtual quasi-static tests of {SPECIMENS} mounts made from {ORIGIN}, loops of "
            f"{', '.join(f'{100 * share:g}' for share in SHARES)} % of the rated travel with {100 * NOISE:g} % of noise, "
            "by identify_specimens; [spread] is the covariance over the five, of rank four"
        ),
        assumed=(
            f"size of the rope's loops scatters by {100 * SIZE:g} %: a height tolerance of 3 mm on 89 mm read as three "
            "standard deviations; vendors state 2 to 6.5 mm by size",
            f"bending stiffness of the rope scatters by {100 * ROPE:g} %, its friction by {100 * FRICTION:g} %: no source",
            "forces of loops of another size are those of rods that do not stretch, F(x) = F_0(x/s) / s^2",
            "the three scatter independently; shape of the loops (n, sigma, k2, axial k3) is that of all specimens together",
            f"everything that {ORIGIN} assumes",
        ),
    )


if __name__ == "__main__":
    main()
