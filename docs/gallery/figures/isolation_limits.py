"""Figure S.1: how near the catalogue's isolators come to the limits of shock isolation."""

import math
from collections.abc import Mapping
from functools import cache, partial

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure as Picture

import wirerope_mj as wr
from figures.drawing import BLUES, COLOURS, GUIDE, INK, canvas, explain, inscribe, note
from figures.figure import Figure
from figures.oscillator import oscillator
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.laws import Law

Array = npt.NDArray[np.float64]

G = wr.STANDARD_GRAVITY
CONSTANT = 0.5
"""a d / V^2 of a constant force."""

VELOCITIES = tuple(float(v) for v in np.geomspace(0.05, 4.0, 25))
"""Steps of the base [m/s]; those that use more than the rated travel are left out."""

DAMPING = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.404, 0.45, 0.5)
"""Damping ratios of the linear curve; from 0.5 on the largest force is that of the damper at the first instant."""

START = 0.01  # [s]
CYCLES = 1.5
"""Periods of the secant at the rated travel that are simulated: the first swing and the rebound."""

Curve = tuple[Array, Array]


def figures() -> list[Figure]:
    """Return figure S.1."""
    return [_figure(measure())]


@cache
def linear(zeta: float) -> float:
    """Return a d / V^2 of a linear mass, k = m = 1 in V = 1 m/s."""
    system = oscillator(wr.KelvinVoigt(k=1.0, c=2.0 * zeta), mass=1.0)
    return efficiency(system, velocity=1.0, seconds=8.0, timestep=2e-3)[1]


def efficiency(system: wr.System, *, velocity: float, seconds: float, timestep: float) -> tuple[float, float]:
    """Return travel [m] of the first swing from the settled position, and its a d / V^2 after a step of the base."""
    step = wr.VelocityStep(velocity=velocity, direction="z", start=START)
    run = wr.simulate(system, step, duration=START + seconds, timestep=timestep, sample_rate=0.5 / timestep)
    sunk = run.mounts["m1"].deflection[0, 2] - run.mounts["m1"].deflection[:, 2]
    rising = run.time > START
    turn = int(np.argmax(np.diff(sunk[rising]) < 0.0)) + int(np.count_nonzero(~rising))
    before, at, after = sunk[turn - 1 : turn + 2]
    travel = at + (after - before) ** 2 / (8.0 * (2.0 * at - before - after))  # top of the parabola through three samples
    peak = run.peaks.bodies["mass"].acceleration
    largest = peak.value
    if peak.time > run.time[turn + 1]:  # in the rebound: what stretches hardens
        largest = float(np.abs(run.bodies["mass"].acceleration[: turn + 2, 2]).max())
    return float(travel), float(largest * travel / velocity**2)


@cache
def curve(law: Law, load: float, rated: float, gravity: float) -> Curve:
    """Return the share of the rated travel used and a d / V^2 under steps of growing velocity."""
    mass = load / G
    system = oscillator(law, mass=mass, gravity=gravity)
    secant = abs(law.trace([0.0, -rated]).force[-1]) / rated
    rate = math.sqrt(secant / mass)  # [rad/s]
    used, ratio = [], []
    for velocity in VELOCITIES:
        travel, value = efficiency(
            system,
            velocity=velocity,
            seconds=CYCLES * 2 * math.pi / rate,
            timestep=0.00125 / rate,  # 5000 in a period
        )
        if travel > rated:
            break
        used.append(travel / rated)
        ratio.append(value)
    return np.array(used), np.array(ratio)


@cache
def rated_isolators() -> tuple[wr.Isolator, ...]:
    """Return the isolators of the catalogue that are rated for a load."""
    found = (wr.load_isolator(path) for path in sorted(catalogue_folder().glob("*.toml")))
    return tuple(isolator for isolator in found if isolator.limits.static_load is not None)


def curves(axis: str) -> dict[str, Curve]:
    """Return the curve of every rated isolator along an axis, by name; along the axial one the payload's weight acts."""
    found = {}
    for isolator in rated_isolators():
        law, rated = isolator.axes[axis], isolator.rated_travel(axis)[0]
        if law is not None and rated is not None and isolator.limits.static_load is not None:
            found[isolator.name] = curve(law, isolator.limits.static_load, rated, G if axis == "axial" else 0.0)
    return found


def measure() -> dict[str, float]:
    """Return the linear limits and where the catalogue lies."""
    numbers = {f"linear_{zeta:g}": linear(zeta) for zeta in DAMPING}
    for axis in ("axial", "shear"):
        found = curves(axis)
        values = np.concatenate([ratio for _, ratio in found.values()])
        last = np.array([ratio[-1] for _, ratio in found.values()])
        half = np.array([np.interp(0.5, *pair) for pair in found.values()])
        numbers |= {f"{axis}_count": len(found), f"{axis}_low": values.min(), f"{axis}_high": values.max()}
        numbers |= {f"{axis}_half_low": half.min(), f"{axis}_half_high": half.max()}
        numbers |= {f"{axis}_last_low": last.min(), f"{axis}_last_high": last.max()}
    return {name: float(value) for name, value in numbers.items()}


def _figure(n: Mapping[str, float]) -> Figure:
    return Figure(
        number="S.1",
        title="Limits of shock isolation, and where the catalogue lies",
        section="shock",
        statement="A sudden velocity V must be stopped within a travel δ: with how little acceleration a can that be done?",
        shown=f"a δ / V² is 0.5 for a force that stays constant, the least there is, and 1 for a linear spring. A damper "
        f"brings a linear mount to {n['linear_0.05']:.3f}, {n['linear_0.15']:.3f} and {n['linear_0.2']:.3f} at 5, 15 and 20 % "
        f"of critical, and to {n['linear_0.404']:.4f} at 40.4 %, its best. The {n['axial_count']:.0f} isolators of the "
        f"catalogue with their rated load lie between {n['axial_low']:.2f} and {n['axial_high']:.2f} in compression: at half "
        f"the rated travel {n['axial_half_low']:.2f} to {n['axial_half_high']:.2f}, at the largest steps drawn "
        f"{n['axial_last_low']:.2f} to {n['axial_last_high']:.2f}: about a linear spring. In shear and roll they harden: "
        f"{n['shear_low']:.2f} at the least, {n['shear_half_low']:.2f} to {n['shear_half_high']:.2f} at half the travel, and "
        f"up to {n['shear_high']:.2f}, above a linear spring. That is far from 0.5, and from the {n['linear_0.1']:.2f} that "
        "10 % of viscous damping would give, although some of their loops dissipate as much: dry friction grows with the "
        "deflection and is largest where the spring is too, while a damper is strongest at the first instant.",
        parameters="Steps of the base from 0.05 to 4 m/s, as far as the travel is rated; a is the largest acceleration of the "
        "payload in the first swing, δ its travel. Linear: k = m = 1. Catalogue: as shipped, fitted to the vendors' "
        "figures, so that what "
        "they hide of the force's curve is hidden here; payload = rated load, settled under it for compression and without "
        "weight along the axis for shear and roll, which share a law.",
        numbers=n,
        draw=partial(_draw, n),
    )


def _draw(n: Mapping[str, float]) -> Picture:
    picture, (damped, axial, shear) = canvas(3, height=4.2)
    damped.plot(DAMPING, [n[f"linear_{zeta:g}"] for zeta in DAMPING], color=INK, lw=1.8)
    best = "0.404"
    for zeta in ("0.05", "0.15", "0.2", best):
        damped.plot(float(zeta), n[f"linear_{zeta}"], "o", color=INK, ms=4.5)
        place = (-6, 9) if zeta == best else (6, 4)
        note(damped, f"{n[f'linear_{zeta}']:.{4 if zeta == best else 3}f}", (float(zeta), n[f"linear_{zeta}"]),
             xytext=place, textcoords="offset points")  # fmt: skip
    inscribe(damped, "linear spring and damper", "damping ratio [-]", "a δ / V² [-]")
    for panel, axis, title in (
        (axial, "axial", "catalogue, compression"),
        (shear, "shear", "catalogue, shear and roll"),
    ):
        for place, (name, (used, ratio)) in enumerate(curves(axis).items()):
            enidine = name.startswith("Enidine")
            colour = BLUES[place] if enidine else COLOURS[1 + place - 4]
            label = name.split(" ", 1)[1]
            panel.plot(used, ratio, color=colour, lw=1.6, ls="-" if enidine else "--", label=label)
        inscribe(panel, title, "travel / rated travel", "a δ / V² [-]")
        panel.set_xlim(0.0, 1.0)
    for panel in (damped, axial, shear):
        for value, words in ((1.0, "linear spring"), (CONSTANT, "constant force")):
            panel.axhline(value, color=GUIDE, lw=1.0, ls=":")
            note(panel, words, (0.02, value + 0.012), colour=GUIDE, xycoords=("axes fraction", "data"))
        panel.set_ylim(0.45, 1.3)
    explain(shear, place="lower right")
    return picture
