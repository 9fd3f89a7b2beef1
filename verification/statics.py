"""Loads, sag and small motions of bodies on mounts against hand calculations, and the vendors' worksheet."""

import math

import numpy as np
from scipy.optimize import brentq

import wirerope_mj as wr
from verification.case import LAST_DIGIT, Case, Comparison, printed, series, single_values
from verification.models import deck, mjcf, mounts, oscillator
from wirerope_mj.assessment.selection import Worksheet
from wirerope_mj.mounts.vendor_parts import vendor_parts

GRAVITY = wr.STANDARD_GRAVITY
PLACES = np.array([[0.5, 0.4], [0.5, -0.4], [0.0, 0.4], [0.0, -0.4], [-0.5, 0.4], [-0.5, -0.4]])
"""Mounts about the origin, symmetric [m]."""


def _box(centre: np.ndarray, stiffness: tuple[float, float, float], gravity: float, turn: str = "") -> wr.System:
    """Return a free box of 120 kg, 0.7 x 0.9 x 0.5 m, on springs at PLACES; `centre` of its mass from their middle [m]."""
    cx, cy, cz = centre.tolist()
    sites = {f"b{i}": f'pos="{x} {y} 1" {turn}' for i, (x, y) in enumerate(PLACES.tolist())}
    points = "".join(f'<site name="p{i}" pos="{x - cx!r} {y - cy!r} {-cz!r}"/>' for i, (x, y) in enumerate(PLACES.tolist()))
    world = deck(sites) + (
        f'<body name="box" pos="{cx!r} {cy!r} {1.0 + cz!r}"><freejoint/>'
        f'<geom type="box" size=".35 .45 .25" mass="120"/>{points}</body>'
    )
    pairs = [(f"m{i}", f"p{i}", f"b{i}", "a") for i in range(len(PLACES))]
    roll, shear, axial = (wr.KelvinVoigt(k=k, c=0.0) for k in stiffness)
    isolator = wr.Isolator(name="a", roll=roll, shear=shear, axial=axial)
    return wr.load_system(mjcf(world, custom=mounts(pairs), gravity=gravity), isolators={"a": isolator})


def _load_split() -> Comparison:
    """Return the comparison of the loads of six mounts below an eccentric centre of mass with the hand formula."""
    ex, ey = 0.07, -0.05
    # So stiff that the box neither tilts nor slides: the formula is for the modelled geometry.
    system = _box(np.array([ex, ey, 0.3]), (1e9, 1e9, 1e9), GRAVITY)
    x, y = PLACES.T
    weight = 120.0 * GRAVITY
    exact = weight * (1.0 / 6.0 + ex * x / (x**2).sum() + ey * y / (y**2).sum())
    rest = wr.equilibrium(system).mounts
    return series(exact, [-rest[f"m{i}"].force[2] for i in range(6)], "N")


def _six_modes() -> Comparison:
    """Return the comparison of the six natural frequencies of a box on turned springs with the textbook's matrices."""
    k, centre = (3e4, 5e4, 9e4), np.array([0.04, -0.03, 0.3])
    turned = np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])  # roll, shear, axial as columns
    stiffness = np.zeros((6, 6))
    for x, y in PLACES:
        a, b, c = x - centre[0], y - centre[1], -centre[2]
        arm = np.hstack([np.eye(3), -np.array([[0.0, -c, b], [c, 0.0, -a], [-b, a, 0.0]])])
        stiffness += arm.T @ turned @ np.diag(k) @ turned.T @ arm
    mass = np.diag([120.0] * 3 + [120.0 / 12.0 * (p * p + q * q) for p, q in ((0.9, 0.5), (0.7, 0.5), (0.7, 0.9))])
    exact = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real)) / (2.0 * math.pi)
    found = wr.modes(_box(centre, k, 0.0, 'xyaxes="0.6 0 -0.8 0 1 0"')).frequencies
    return single_values({f"mode {i + 1}": (exact[i], found[i]) for i in range(6)}, "Hz")


def _sag() -> Comparison:
    """Return the comparison of the virgin and the relaxed sag of a mass on Ni's law with roots of its equations."""
    alpha, beta, k1, k3, rate, mass = 7.5e5, 118.0, 3.9e5, 4e7, 5.7, 220.0
    law = wr.AsymmetricBoucWen(alpha=alpha, beta=beta, gamma=0.0, n=1.0, k1=k1, k2=0.0, k3=k3, b=math.e, c=rate)
    system, pairs = oscillator({"one": law}, mass=mass, gravity=GRAVITY), {}
    for history in ("virgin", "relaxed"):

        def balance(x: float, history: str = history) -> float:
            z = alpha / beta * (1.0 - math.exp(-beta * x)) if history == "virgin" else 0.0
            return math.exp(-rate * x) * (z + k1 * x + k3 * x**3) - mass * GRAVITY

        found = wr.equilibrium(system, history=history).mounts["m_one"].deflection[2]
        pairs[f"{history} [mm]"] = (1e3 * brentq(balance, 0.0, 0.03, xtol=1e-15), -1e3 * found)
    return single_values(pairs, "mm")


def _worksheet() -> Comparison:
    """Return the comparison of a catalogue's worked example with the worksheet."""
    g = 9.81  # what gives the printed digits
    selection = wr.select_isolators(mass=200.0, mounts=4, drop=0.15, fragility=15.0 * g, disturbance=40.0)
    sheet = selection.worksheet
    part = next(found for found in selection.candidates if found.part.name == "WR12-606-06")
    return printed(
        {
            "load on a mount [N]": ("490.5", sheet.load),
            "frequency that isolates [Hz]": ("13.33", sheet.largest_frequency or math.nan),
            "vibration stiffness at most [N/mm]": ("351", (sheet.largest_vibration_stiffness or math.nan) / 1e3),
            "velocity change [m/s]": ("1.716", sheet.velocity),
            "travel at least [mm]": ("20.0", (sheet.smallest_travel or math.nan) * 1e3),
            "shock stiffness at most [N/mm]": ("368", (sheet.largest_shock_stiffness or math.nan) / 1e3),
            "travel of WR12-606-06 [mm]": ("49.5", part.travel * 1e3),
            "frequency of WR12-606-06 [Hz]": ("8.33", part.frequency),
            "acceleration of WR12-606-06 [g]": ("6.1", part.acceleration / g),
        }
    )


def _linear_rack() -> Comparison:
    """Return the comparison of the linear shock check of the 850 kg rack with the printed one."""
    part = next(part for part in vendor_parts() if part.name == "CB1400-15")
    stiffness = part.modes["compression"].shock or math.nan
    sheet = Worksheet(mass=850.0, mounts=6, shock=wr.VelocityStep(velocity=1.0791, direction="z"))
    return printed(
        {
            "shock stiffness [N/m]": ("464086", stiffness),
            "frequency [Hz]": ("9.109", sheet.frequency(stiffness)),
            "acceleration [g]": ("6.296", sheet.acceleration(stiffness) / 9.81),
            "travel [mm]": ("18.85", sheet.dynamic_travel(stiffness) * 1e3),
        }
    )


CASES = (
    Case(name="load-split", title="Loads of six mounts below an eccentric centre of mass",
         compares="Static load of each mount; largest difference over the largest load.",
         source="closed form W [1/n + ex x/sum(x^2) + ey y/sum(y^2)] of equal mounts in a symmetric pattern", date="each run",
         bound=1e-5, run=_load_split,
         reason="the mounts of 1 GN/m yield by a micrometre, and the centre of mass moves with them"),
    Case(name="six-modes", title="Six natural frequencies of a box on springs turned by 53 degrees",
         compares="All six frequencies, without gravity; largest relative difference.",
         source="K = sum of G^T R diag(k) R^T G about the centre of mass, eigenvalues by NumPy", date="each run", bound=1e-7,
         reason="the library differentiates forces over 1e-6 m", run=_six_modes),
    Case(name="sag-asymmetric", title="Virgin and relaxed sag of a mass on Ni's asymmetric law",
         compares="Both deflections; largest relative difference.",
         source="roots of exp(-c x) [z(x) + k1 x + k3 x^3] = m g, z = alpha/beta (1 - exp(-beta x)) or 0", date="each run",
         bound=1e-7, reason="the equilibrium's accelerations vanish to a few 1e-8 of gravity", run=_sag),
    Case(name="enidine-worksheet", title="The vendors' worksheet: 200 kg on four mounts", kind="published",
         compares="Nine values of the example; difference in half units of the last digit printed.",
         source="worked example for ITT Enidine's wire-rope isolators (catalogue ENI877R4), from a public transcription",
         date="before 2026", bound=1.0, reason=LAST_DIGIT, run=_worksheet),
    Case(name="linear-shock-check", title="Linear shock check of an 850 kg rack on six CB1400-15", kind="published",
         compares="Four values; difference in half units of the last digit printed.",
         source="energy method of the VMC Group's technical notes on wire rope isolators, worked for this rack in a public "
         "transcription", date="before 2026", bound=1.0, reason=LAST_DIGIT, run=_linear_rack),
)  # fmt: skip
