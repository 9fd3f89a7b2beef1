"""Vendors' simulations of racks, computed with the isolator files as they are and translations alone.

The sheets give neither the positions of the mounts nor the centre of mass. A rack that only translates needs neither: along
each axis it is one mass on all its mounts in parallel. Mounts below stand on their axis, with roll along X and shear along Y;
stabilisers at the back work along X, with shear along Y and roll vertical.
"""

import math
from dataclasses import dataclass, field

import wirerope_mj as wr
from verification.case import Case, Comparison, single_values
from verification.models import oscillator
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.laws import Law

BOUND = 0.1
"""Largest relative error allowed of any value of a rack."""

REASON = (
    "what the vendor's own figures of the isolators agree to among each other. Fitted to the rack of 850 kg: shear (its mode "
    "and shock along Y) and the amplitude of its modes; to that of 320 kg: the yield deflection (its sag); to both small "
    "racks: one amplitude of modes. Modes along X of 18 and 19 Hz are no translation of a rack on such mounts: left out"
)
SOURCE = (
    "Socitec, sheets of its nonlinear simulation (SDNL1, WINSDNL1) of racks under a 20 g 11 ms sawtooth taken as a velocity "
    "step, read from a public transcription"
)


@dataclass(frozen=True, kw_only=True)
class Rack:
    """A rack of a vendor's sheet.

    Attributes:
        mass: [kg].
        below, behind: number of mounts below and of stabilisers.
        isolator: name of the catalogue's file.
        sag: static deflection [mm].
        amplitude: of the modes [m]; the sheets do not say theirs.
        modes: by axis [Hz].
        travel: largest displacement under the velocity step along X, Y and Z [mm]; none where the sheet gives none.
        acceleration: the same for the acceleration [g].
    """

    mass: float
    below: int
    behind: int
    isolator: str
    sag: float
    amplitude: float
    modes: dict[str, float]
    travel: tuple[float, ...] = field(default=())
    acceleration: tuple[float, ...] = field(default=())


RACKS = {
    "rack-850-kg": Rack(
        mass=850.0, below=6, behind=4, isolator="socitec_cb1400_15", sag=0.613, amplitude=12.5e-3,
        modes={"X": 10.42, "Y": 6.98, "Z": 11.68},
        travel=(15.89, 20.79, 15.22), acceleration=(7.05, 5.96, 7.17),
    ),
    "rack-320-kg": Rack(
        mass=320.0, below=4, behind=2, isolator="socitec_cb1390_30", sag=1.4, amplitude=5e-3,
        modes={"Y": 7.4, "Z": 10.5},
    ),
    "rack-610-kg": Rack(
        mass=609.86, below=6, behind=2, isolator="socitec_cb1390_20", sag=1.2, amplitude=5e-3,
        modes={"Y": 8.1, "Z": 11.3},
    ),
}  # fmt: skip
VELOCITY = 20.0 * wr.STANDARD_GRAVITY * 11e-3 / 2.0
"""Velocity change of the sawtooth [m/s]."""


def _along(rack: Rack, axis: int) -> wr.System:
    """Return the rack with a slide along one of its axes X, Y, Z alone; gravity acts along Z."""
    isolator = wr.load_isolator(catalogue_folder() / f"{rack.isolator}.toml")
    own = {"roll": isolator.roll, "shear": isolator.shear, "axial": isolator.axial}
    laws: dict[str, Law] = {}
    for place, number, axes in (
        ("below", rack.below, ("roll", "shear", "axial")),
        ("behind", rack.behind, ("axial", "shear", "roll")),
    ):
        law = own[axes[axis]]
        if law is None:
            raise RuntimeError(f"{rack.isolator} has no law along {axes[axis]}.")
        laws |= {f"{place}{i}": law for i in range(number)}
    return oscillator(laws, mass=rack.mass, gravity=wr.STANDARD_GRAVITY if axis == 2 else 0.0)


def _shock(system: wr.System, senses: tuple[float, ...]) -> tuple[float, float]:
    """Return travel from rest [mm] and acceleration [g] under the velocity step, the larger of the senses."""
    travel = acceleration = 0.0
    for sense in senses:
        step = wr.VelocityStep(velocity=sense * VELOCITY, direction="z")
        response = wr.simulate(system, step, duration=0.3)
        deflection = response.mounts["m_below0"].deflection[:, 2]
        peak = response.peaks.mounts["m_below0"].deflection
        travel = max(travel, peak.maximum[2] - deflection[0], deflection[0] - peak.minimum[2])
        acceleration = max(acceleration, response.peaks.bodies["mass"].acceleration.value)
    return 1e3 * travel, acceleration / wr.STANDARD_GRAVITY


def _rack(rack: Rack) -> Comparison:
    """Return the comparison of all values that the sheet gives of a rack."""
    systems = [_along(rack, axis) for axis in range(3)]
    rest = wr.equilibrium(systems[2]).mounts["m_below0"].deflection[2]
    pairs = {"static deflection [mm]": (rack.sag, -1e3 * rest)}
    for axis, stated in rack.modes.items():
        pairs[f"mode along {axis} [Hz]"] = (stated, _frequency(systems["XYZ".index(axis)], rack.amplitude))
    if rack.travel:
        # Upwards the deck starts upwards, as the vendor's initial velocity does: the mounts are compressed first.
        found = [_shock(system, (1.0,) if axis == 2 else (1.0, -1.0)) for axis, system in enumerate(systems)]
        pairs |= {f"travel along {axis} [mm]": (rack.travel[i], found[i][0]) for i, axis in enumerate("XYZ")}
        pairs |= {f"acceleration along {axis} [g]": (rack.acceleration[i], found[i][1]) for i, axis in enumerate("XYZ")}
    return single_values(pairs, "see below")


def _frequency(system: wr.System, amplitude: float) -> float:
    """Return the natural frequency of a rack that translates [Hz]; NaN becomes an error."""
    frequency = float(wr.modes(system, amplitude=amplitude).frequencies[0])
    if not math.isfinite(frequency):
        raise RuntimeError("the rack has no natural frequency.")
    return frequency


CASES = tuple(
    Case(
        name=name,
        title=f"Rack of {rack.mass:g} kg on {rack.below} mounts below and {rack.behind} behind, {rack.isolator}",
        compares="Static deflection, modes"
        + (", and travel and acceleration after a velocity step of 1.08 m/s" if rack.travel else "")
        + f"; translations only, modes at {1e3 * rack.amplitude:g} mm; largest relative difference.",
        source=SOURCE,
        date="before 2026",
        bound=BOUND,
        reason=REASON,
        kind="plausibility",
        run=lambda rack=rack: _rack(rack),  # type: ignore[misc]
    )
    for name, rack in RACKS.items()
)
