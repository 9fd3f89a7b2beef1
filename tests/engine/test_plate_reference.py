"""Hysteretic mounts on a steel plate, and below a free beam: a few modes against all degrees of freedom of own finite elements.

The reference takes every mode of plate or beam over each step exactly, the mounts' forces straight between steps (Nigam and
Jennings 1969), and the body and the mounts' states by the trapezoidal rule, repeated until the forces are those at its end.
"""

import numpy as np
import pytest
import scipy.linalg
from fe_plate import plate
from house import mjcf

import wirerope_mj as wr

# some decks have too few modes on purpose
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore:the modes of the deck")]

A, B, H, NX, NY = 3.6, 2.6, 0.010, 14, 12  # plate [m]; 429 degrees of freedom clamped, 477 simply supported
NODES = {"m1": (5, 4), "m2": (9, 4), "m3": (5, 8), "m4": (9, 8)}
MASS, INERTIA, OFF = 420.0, (40.0, 60.0, 80.0), 0.1  # body, its centre beside that of the mounts [m]
ALPHA, Z_MAX, K, ACROSS = 5e5, 2e3, 1.5e5, 1e5
ZETA = 0.03
LAW = wr.BoucWen(alpha=ALPHA, beta=0.5 * ALPHA / Z_MAX, gamma=0.5 * ALPHA / Z_MAX, n=1.0, k=K)
DURATION, STEP = {"half-sine": 0.2, "double pulse": 0.2, "random": 0.5}, 2e-5
MOTIONS = {
    "half-sine": wr.HalfSine(peak=15.0 * wr.STANDARD_GRAVITY, duration=0.011, direction="z", start=0.02),
    "double pulse": wr.DoubleHalfSine(peak=200.0, velocity=1.2, displacement=0.03, direction="z", start=0.02),
    "random": wr.RandomVibration(
        psd=[(5.0, 1.0), (60.0, 1.0)], duration=DURATION["random"], seed=3, direction="z"
    ),
}  # fmt: skip


def places():
    return {name: (A * (i / NX - 0.5), B * (j / NY - 0.5), 0.5) for name, (i, j) in NODES.items()}


def part_of(fe, count, *, residual=False):
    """Return the part of the lowest modes of a plate, with a point at every mount.

    `residual` adds residual vectors, as FE programs do: what the modes left out give way statically under a force at each
    mount and under the base's acceleration, made orthogonal to the modes and to each other by the matrices (Rayleigh and Ritz).
    """
    omega, shapes, _ = fe.modes(count)
    if residual:
        loads = np.zeros((fe.mass.shape[0], len(NODES) + 1))
        loads[:, -1] = fe.force
        for number, node in enumerate(NODES.values()):
            loads[fe.deflection[node], number] = 1.0
        rest = np.linalg.solve(fe.stiffness, loads) - shapes @ ((shapes.T @ loads) / omega[:, np.newaxis] ** 2)
        basis = np.hstack([shapes, rest / np.linalg.norm(rest, axis=0)])
        values, within = scipy.linalg.eigh(basis.T @ fe.stiffness @ basis, basis.T @ fe.mass @ basis)
        omega, shapes = np.sqrt(values), basis @ within
    up = np.array([0.0, 0.0, 1.0])
    return wr.FlexiblePart(
        frequencies=omega / (2 * np.pi), damping=ZETA, participation=np.outer(shapes.T @ fe.force, up), points=places(),
        shapes={name: np.outer(shapes[fe.deflection[node]], up) for name, node in NODES.items()},
    )  # fmt: skip


def rigid_system():
    """Return the body on its mounts on a rigid deck."""
    sites = "".join(f'<site name="b{n}" pos="{x} {y} {z}"/>' for n, (x, y, z) in places().items())
    slides = "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    above = "".join(f'<site name="p{n}" pos="{x - OFF} {y} 0"/>' for n, (x, y, _) in places().items())
    world = f'<body name="deck">{slides}<geom size=".1" mass="5"/>{sites}</body>'
    world += f'<body name="box" pos="{OFF} 0 .5"><freejoint/><inertial pos="0 0 0" mass="{MASS}" '
    world += f'diaginertia="{INERTIA[0]} {INERTIA[1]} {INERTIA[2]}"/>{above}</body>'
    across = wr.KelvinVoigt(k=ACROSS, c=0.0)
    isolator = wr.Isolator(name="w", axial=LAW, shear=across, roll=across)
    return wr.load_system(mjcf(world, [(n, f"p{n}", f"b{n}", "w") for n in NODES]), isolators={"w": isolator})


def plate_reference(fe, motion, duration):
    """Return peaks of the body on the plate with all its modes."""
    omega, shapes, participation = fe.modes(fe.mass.shape[0])
    phi = shapes[[fe.deflection[node] for node in NODES.values()]]  # (4, n)
    arms = np.array([(x - OFF, y) for x, y, _ in places().values()])
    return reference((omega, phi, participation), arms, (MASS, *INERTIA[:2]), motion, duration)


def reference(modes, arms, inertia, motion, duration):
    """Return peaks of the full model: acceleration of the rigid body, then deflections and forces of the mounts.

    `modes` are angular frequencies, how far each takes a mount's base up, and participations; `arms` the mounts from the
    body's centre along x and y.
    """
    omega, phi, participation = modes
    damped, decay, h = omega * np.sqrt(1 - ZETA**2), ZETA * omega, STEP
    e, c, s = np.exp(-decay * h), np.cos(damped * h), np.sin(damped * h)
    own = np.array(
        [[e * (c + decay / damped * s), e * s / damped], [-(omega**2) * e * s / damped, e * (c - decay / damped * s)]]
    )
    # responses at the end of a step to a force of 1 throughout, and to one that rises from 0 to 1
    constant = np.array([(1 - own[0, 0]) / omega**2, own[0, 1]])
    ramp = np.array([(h - constant[1] - 2 * ZETA / omega * (1 - own[0, 0])) / omega**2 / h, constant[0] / h])
    n = len(arms)
    to_sites = np.column_stack([np.ones(n), arms[:, 1], -arms[:, 0]])  # by z and turns about x and y
    times = np.arange(0.0, duration + h / 2, h)
    base = motion.acceleration(times)[:, 2]
    q, qd, x, v, z = np.zeros(omega.size), np.zeros(omega.size), np.zeros(3), np.zeros(3), np.zeros(n)
    f, a = np.zeros(n), np.array([-base[0], 0.0, 0.0])
    push = phi.T @ f - participation * base[0]
    rate, slope = np.zeros(n), np.zeros(n)
    peaks = np.zeros(2 * n + 1)
    for k in range(1, times.size):
        f_new = f.copy()
        for _ in range(4):
            push_new = phi.T @ f_new - participation * base[k]
            q_new = own[0, 0] * q + own[0, 1] * qd + (constant[0] - ramp[0]) * push + ramp[0] * push_new
            qd_new = own[1, 0] * q + own[1, 1] * qd + (constant[1] - ramp[1]) * push + ramp[1] * push_new
            a_new = -(to_sites.T @ f_new) / np.array(inertia) - np.array([base[k], 0.0, 0.0])
            v_new, x_new = v + 0.5 * h * (a + a_new), x + h * v + h * h / 6 * (2 * a + a_new)
            d, rate_new = to_sites @ x_new - phi @ q_new, to_sites @ v_new - phi @ qd_new
            z_new = z + 0.5 * h * (slope + slope_of(rate_new, z))
            for _inner in range(2):
                z_new = z + 0.5 * h * (slope + slope_of(rate_new, z_new))
            f_new = K * d + z_new
        q, qd, x, v, z, f, a = q_new, qd_new, x_new, v_new, z_new, f_new, a_new
        push, rate = push_new, rate_new
        slope = slope_of(rate, z)
        peaks = np.maximum(peaks, np.abs(np.concatenate([[a[0] + base[k]], d, f])))
    return peaks


def slope_of(rate, z):
    return rate * (ALPHA - np.abs(z) * (LAW.beta * np.sign(rate * z) + LAW.gamma))


def peaks_of(system, motion, duration, timestep=5e-5):
    r = wr.simulate(system, motion, duration=duration, timestep=timestep, sample_rate=2000.0)
    largest = [r.peaks.bodies["box"].acceleration]
    axial = [np.abs([p.minimum[2], p.maximum[2]]).max() for p in (mount.deflection for mount in r.peaks.mounts.values())]
    force = [np.abs([p.minimum[2], p.maximum[2]]).max() for p in (mount.force for mount in r.peaks.mounts.values())]
    up = np.abs([largest[0].minimum[2], largest[0].maximum[2]]).max()
    return np.array([up, *axial, *force])


@pytest.mark.parametrize("clamped", [True, False], ids=["clamped", "simply supported"])
@pytest.mark.parametrize("name", MOTIONS)
def test_modes_stand_for_the_whole_plate(clamped, name):
    fe, rigid = plate(A, B, H, NX, NY, clamped=clamped), rigid_system()
    expected = plate_reference(fe, MOTIONS[name], DURATION[name])
    decks = {f"{count} modes": part_of(fe, count) for count in (4, 30)}
    decks["30 and residual"] = part_of(fe, 30, residual=True)
    whole = part_of(fe, fe.mass.shape[0])
    decks["30 of all and residual"] = whole.below(float(whole.frequencies[29]), residual=True)  # as `wirerope flexible` does
    systems = {"rigid": rigid} | {deck: wr.on_deck(rigid, part) for deck, part in decks.items()}
    off = {
        deck: np.abs(peaks_of(system, MOTIONS[name], DURATION[name]) / expected - 1.0).max() for deck, system in systems.items()
    }
    print(name, {deck: f"{100 * value:.2f} %" for deck, value in off.items()})
    # what is asked of a truncated model is 1 %; with residual vectors 0.1 % is left, which is the reference's own
    assert max(off["30 and residual"], off["30 of all and residual"]) < 2e-3
    assert off["30 modes"] < 0.03
    assert off["30 modes"] < off["4 modes"] < off["rigid"]


LENGTH, BENDING, LINE, N = 2.4, 6e4, 120.0, 200  # free beam from 13.8 Hz [m, N m2, kg/m], of 402 degrees of freedom
ENDS = {"m1": 10, "m2": 160}  # nodes above the mounts: at -1.08 and 0.72 m
WIDE = 0.1  # half the width by which the beam's box has a moment of inertia about itself [m]


@pytest.fixture(scope="module")
def beam():
    """Return angular frequencies of the elastic modes of the free beam, its shapes at the mounts, and its mass and inertia."""
    h = LENGTH / N
    to = np.diag([1.0, h, 1.0, h])  # Hermite's cubics, slopes in units of the element
    stiff = BENDING / h**3 * to @ [[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]] @ to
    heavy = LINE * h / 420 * to @ [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]] @ to
    k, m = np.zeros((2, 2 * N + 2, 2 * N + 2))
    for first in range(0, 2 * N, 2):
        k[first : first + 4, first : first + 4] += stiff
        m[first : first + 4, first : first + 4] += heavy
    values, shapes = scipy.linalg.eigh(k, m)
    omega = np.sqrt(values[2:])
    closed = 4.730041**2 / LENGTH**2 * np.sqrt(BENDING / LINE)  # a free beam's lowest
    assert omega[0] == pytest.approx(closed, rel=1e-5)
    about = np.column_stack([np.tile([0.0, 1.0], N + 1)])
    about[::2, 0] = np.linspace(-LENGTH / 2, LENGTH / 2, N + 1)
    return omega, shapes[[2 * node for node in ENDS.values()], 2:], LINE * LENGTH, float((about.T @ m @ about).item())


def beam_system(beam, count, *, residual=False):
    """Return the beam on its mounts, by its lowest modes; by their residual vectors under forces of the mounts, too."""
    omega, phi, mass, about = beam
    arms = [LENGTH * (node / N - 0.5) for node in ENDS.values()]
    sites = [
        ("".join(f'<site name="{s}{n}" pos="{x} 0 {z}"/>' for n, x in enumerate(arms, 1))) for s, z in (("b", 0.5), ("p", 0))
    ]
    slides = "".join(f'<joint type="slide" axis="{a}"/>' for a in ("1 0 0", "0 1 0", "0 0 1"))
    world = f'<body name="deck">{slides}<geom size=".1" mass="5"/>{sites[0]}</body><body name="box" pos="0 0 .5">'
    world += '<joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>'
    world += f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{mass * WIDE**2} {about} {about}"/>{sites[1]}</body>'
    across = wr.KelvinVoigt(k=ACROSS, c=0.0)
    isolator = wr.Isolator(name="w", axial=LAW, shear=across, roll=across)
    mounts = [(name, f"p{n}", f"b{n}", "w") for n, name in enumerate(ENDS, 1)]
    system = wr.load_system(mjcf(world, mounts), isolators={"w": isolator})
    frequencies, shapes = omega[:count], phi[:, :count]
    if residual:  # of what is left out, the part that forces at the mounts bend statically, by Rayleigh and Ritz
        left, squares = phi[:, count:], omega[count:] ** 2
        values, within = scipy.linalg.eigh((left / squares) @ left.T, (left / squares**2) @ left.T)
        frequencies = np.concatenate([frequencies, np.sqrt(values)])
        shapes = np.hstack([shapes, (left / squares) @ left.T @ within])
    if not count and not residual:
        return system
    up, points = np.array([0.0, 0.0, 1.0]), {f"p{n}": (x, 0.0, 0.0) for n, x in enumerate(arms, 1)}
    part = wr.FlexiblePart(
        frequencies=frequencies / (2 * np.pi), damping=ZETA, points=points,
        shapes={name: np.outer(row, up) for name, row in zip(points, shapes, strict=True)},
    )  # fmt: skip
    return wr.with_flexible(system, part, body="box")


@pytest.mark.parametrize("name", MOTIONS)
def test_free_modes_stand_for_equipment_that_bends(beam, name):
    omega, phi, mass, about = beam
    arms = np.array([(LENGTH * (node / N - 0.5), 0.0) for node in ENDS.values()])
    modes = omega, -phi, np.zeros(omega.size)  # what the beam bends up by stretches a mount, as what a deck bends down by
    expected = reference(modes, arms, (mass, mass * WIDE**2, about), MOTIONS[name], DURATION[name])
    cases = {"rigid": (0, False)} | {f"{count} modes": (count, False) for count in (1, 2, 8)} | {"4 and residual": (4, True)}
    off = {
        case: np.abs(peaks_of(beam_system(beam, n, residual=r), MOTIONS[name], DURATION[name], 2e-5) / expected - 1.0).max()
        for case, (n, r) in cases.items()
    }
    print(name, {case: f"{100 * value:.2f} %" for case, value in off.items()})
    assert off["4 and residual"] < 2e-3
    assert off["8 modes"] < 0.01
    assert off["8 modes"] < off["2 modes"] < off["1 modes"] < off["rigid"]
