"""Free bodies on inclined mounts against Newton's and Euler's equations, written here without MuJoCo.

Two bodies: the lower stands on four mounts on a driven deck, the upper on three mounts on the lower one, whose base sites turn
with it. Every mount has a frame of its own, leaning; its deflection is taken in the axes of its base site as that site turns.
Both forces of a mount act at the payload's point, which is how the library states it.
"""

from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

import wirerope_mj as wr
from verification.case import Case, Comparison, series
from verification.models import deck, mjcf, mounts
from verification.newton_euler import rotation_matrix

Array = np.ndarray

GRAVITY = wr.STANDARD_GRAVITY
PEAK, LENGTH, START = 50.0 * GRAVITY, 0.012, 0.01
DIRECTION = np.array([0.8, 0.48, 0.36])


MASSES = np.array([60.0, 9.0])
"""Of both bodies [kg]."""

INERTIAS = np.array([[1.1, 1.7, 2.2], [0.05, 0.09, 0.11]])
"""Principal inertias about the centres [kg m^2], axes along the world's in the modelled geometry."""

CENTRES = np.array([[0.04, -0.05, 0.68], [0.06, 0.03, 1.0]])
"""Centres of mass in the modelled geometry [m]."""

LOWER = ((0.3, 0.25, 0.42), (0.3, -0.25, 0.45), (-0.35, 0.2, 0.42), (-0.3, -0.3, 0.47))
UPPER = ((0.12, 0.1, 0.8), (-0.1, 0.12, 0.82), (0.0, -0.12, 0.8))
LATERAL = np.array([[1.0e4, 60.0], [1.4e4, 40.0]])
"""Stiffness [N/m] and damper [N s/m] along roll and along shear."""

ALPHA, BETA, GAMMA, SPRING = 3.0e4, 90.0, 20.0, 8.0e3
"""Bouc-Wen's law along the axis, n = 1."""


def _frame(lean: float, turn: float) -> Array:
    """Return roll, shear and axial direction as columns: leaning about y, then turned about z [rad]."""
    a, b = np.cos(lean), np.sin(lean)
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array([[a, 0.0, b], [0.0, 1.0, 0.0], [-b, 0.0, a]])


POINTS = np.array(LOWER + UPPER)
FRAMES = np.array([_frame(0.6 - 0.25 * i, 0.9 * i) for i in range(len(POINTS))])
PAYLOAD = np.array([0] * len(LOWER) + [1] * len(UPPER))


@njit(cache=True)
def _deck_motion(t: float) -> tuple[Array, Array]:
    """Return displacement and velocity of the deck under a half-sine."""
    s = min(max((t - START) / LENGTH, 0.0), 1.0)
    velocity = PEAK * LENGTH / np.pi * (1.0 - np.cos(np.pi * s))
    displacement = PEAK * LENGTH**2 / np.pi * (s - np.sin(np.pi * s) / np.pi) + velocity * max(t - START - LENGTH, 0.0)
    return displacement * DIRECTION, velocity * DIRECTION


@njit(cache=True)
def _push(i: int, states: Array, turns: Array, spins: Array, deck: tuple[Array, Array], z: float) -> tuple[Array, Array, float]:
    """Return force of mount i on its payload, the point where it acts, and the rate of its z."""
    upper = PAYLOAD[i]
    arm = turns[upper] @ (POINTS[i] - CENTRES[upper])
    top, top_speed = states[upper, :3] + arm, states[upper, 7:10] + np.cross(spins[upper], arm)
    axes, spin, foot, foot_speed = FRAMES[i].copy(), np.zeros(3), POINTS[i] + deck[0], deck[1]
    if upper == 1:  # the base site turns with the lower body
        base_arm = turns[0] @ (POINTS[i] - CENTRES[0])
        axes, spin = turns[0] @ FRAMES[i], spins[0]
        foot, foot_speed = states[0, :3] + base_arm, states[0, 7:10] + np.cross(spin, base_arm)
    d = axes.T @ (top - foot)
    v = axes.T @ (top_speed - foot_speed - np.cross(spin, top - foot))
    f = np.array([LATERAL[0, 0] * d[0] + LATERAL[0, 1] * v[0], LATERAL[1, 0] * d[1] + LATERAL[1, 1] * v[1], SPRING * d[2] + z])
    return -axes @ f, top, v[2] * (ALPHA - (GAMMA + BETA * np.sign(v[2] * z)) * abs(z))


@njit(cache=True)
def _rates(t: float, y: Array) -> Array:
    """Return the rates of position 3, quaternion 4, velocity 3, body angular velocity 3 of both bodies, and of all z."""
    states, z = y[:26].copy().reshape(2, 13), y[26:]
    turns, spins, torque = np.empty((2, 3, 3)), np.empty((2, 3)), np.zeros((2, 3))
    force = np.zeros((2, 3))
    out = np.empty(y.size)
    for b in range(2):
        turns[b] = rotation_matrix(states[b, 3:7])
        spins[b] = turns[b] @ states[b, 10:13].copy()
        force[b, 2] = -GRAVITY * MASSES[b]
    deck = _deck_motion(t)
    for i in range(z.size):
        push, point, out[26 + i] = _push(i, states, turns, spins, deck, z[i])
        payload = PAYLOAD[i]
        force[payload] += push
        torque[payload] += np.cross(point - states[payload, :3], push)
        if payload == 1:
            force[0] -= push
            torque[0] -= np.cross(point - states[0, :3], push)
    for b in range(2):
        q, w, first = states[b, 3:7], states[b, 10:13], 13 * b
        out[first : first + 3] = states[b, 7:10]
        out[first + 3] = -0.5 * np.sum(q[1:] * w)
        out[first + 4 : first + 7] = 0.5 * (q[0] * w + np.cross(q[1:], w))
        out[first + 7 : first + 10] = force[b] / MASSES[b]
        out[first + 10 : first + 13] = (turns[b].T @ torque[b] - np.cross(w, INERTIAS[b] * w)) / INERTIAS[b]
    return out


def _solve(times: Array) -> tuple[Array, float]:
    """Return four marked points of each body (n_t, 2, 4, 3) [m] and the largest rotation of a body [degrees]."""
    start = np.zeros(26 + len(POINTS))
    for i in range(2):
        start[13 * i : 13 * i + 3], start[13 * i + 3] = CENTRES[i], 1.0
    states, y = np.empty((times.size, 26)), start
    corners = [0.0, START, START + LENGTH, float(times[-1])]
    for begin, end in zip(corners[:-1], corners[1:], strict=True):
        # Short steps, so that no kink of a mount is stepped over unseen; the error control shortens them there.
        run = solve_ivp(_rates, (begin, end), y, "DOP853", rtol=1e-8, atol=1e-10, max_step=1e-3, dense_output=True)
        inside = (times >= begin) & (times <= end)
        states[inside], y = run.sol(times[inside])[:26].T, run.y[:, -1]
    marked = np.array([_marked(state.reshape(2, 13)[:, :7]) for state in states])
    angle = 2.0 * np.arccos(np.clip(np.abs(states.reshape(-1, 13)[:, 3]), 0.0, 1.0))
    return marked, float(np.degrees(angle.max()))


def _marked(poses: Array) -> Array:
    """Return centre and three points 0.5 m from it along the axes of each body, from position and quaternion (2, 7)."""
    return np.array([[p[:3], *(p[:3] + 0.5 * rotation_matrix(p[3:]).T)] for p in poses])


def _system() -> wr.System:
    """Return the same two bodies as a MuJoCo model."""

    def numbers(values: Sequence[float] | Array) -> str:
        return " ".join(f"{value:.17g}" for value in values)

    def site(name: str, i: int, origin: Array) -> str:
        frame = f'xyaxes="{numbers([*FRAMES[i][:, 0], *FRAMES[i][:, 1]])}"'
        return f'<site name="{name}{i}" pos="{numbers(POINTS[i] - origin)}" {frame}/>'

    sites = {f"d{i}": f'pos="{numbers(POINTS[i])}" xyaxes="{numbers([*FRAMES[i][:, 0], *FRAMES[i][:, 1]])}"' for i in range(4)}
    world = deck(sites)
    for index, centre in enumerate(CENTRES):
        own = "".join(site("p", i, centre) for i, payload in enumerate(PAYLOAD) if payload == index)
        if index == 0:
            own += "".join(site("b", i, centre) for i, payload in enumerate(PAYLOAD) if payload == 1)
        world += (
            f'<body name="body{index}" pos="{numbers(centre)}"><freejoint/><inertial pos="0 0 0" '
            f'mass="{numbers(MASSES[index : index + 1])}" diaginertia="{numbers(INERTIAS[index])}"/>{own}</body>'
        )
    pairs = [(f"m{i}", f"p{i}", f"b{i}" if PAYLOAD[i] else f"d{i}", "a") for i in range(len(POINTS))]
    custom = '<tuple name="base"><element objtype="body" objname="deck"/></tuple>' + mounts(pairs)
    roll, shear = (wr.KelvinVoigt(k=float(k), c=float(c)) for k, c in LATERAL)
    axial = wr.BoucWen(alpha=ALPHA, beta=BETA, gamma=GAMMA, n=1.0, k=SPRING)
    isolator = wr.Isolator(name="a", roll=roll, shear=shear, axial=axial)
    return wr.load_system(mjcf(world, custom=custom, gravity=GRAVITY), isolators={"a": isolator})


def _two_bodies() -> Comparison:
    """Return the comparison of where marked points of both bodies are, over 0.5 s."""
    motion = wr.HalfSine(peak=PEAK, duration=LENGTH, start=START, direction=DIRECTION.tolist())
    response = wr.simulate(_system(), motion, duration=0.5, initial="unloaded", timestep=5e-5, sample_rate=500.0)
    expected, angle = _solve(response.time)
    poses = np.stack(
        [np.hstack([response.bodies[f"body{i}"].position, response.bodies[f"body{i}"].orientation]) for i in range(2)],
        axis=1,
    )
    found = np.array([_marked(pose) for pose in poses])
    if angle < 40.0:
        raise RuntimeError(f"the bodies turn by {angle:.3g} degrees only: the case is not what it says.")
    carried = expected[0] + np.array([_deck_motion(t)[0] for t in response.time])[:, None, None, :]
    return series(expected - carried, found - carried, "m")


CASES = (
    Case(
        name="two-bodies-inclined-mounts",
        title="Two free bodies on seven inclined mounts under an oblique 50 g half-sine, turning by more than 40 degrees",
        compares="Displacements of the centre and of three points 0.5 m away of both bodies at 251 instants, from release "
        "under gravity; largest difference over the largest displacement from the deck.",
        source="Newton's and Euler's equations with quaternions, integrated by SciPy's DOP853, written in verification/"
        "rigid_bodies.py without MuJoCo",
        date="each run",
        bound=1e-6,
        reason="steps of 50 microseconds are of second order at the mounts' reversals",
        run=_two_bodies,
    ),
)
