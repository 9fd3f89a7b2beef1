"""A box on four mounts on a base that rotates, and Newton's and Euler's equations of it."""

import math
from functools import cache

import numpy as np
from house import mjcf
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import wirerope_mj as wr

GRAVITY = 9.80665
MASS, INERTIA = 40.0, np.array([1.1, 0.7, 0.9])  # kg, kg m^2 about the box's own axes
CORNERS = np.array(
    [[0.3, 0.2, -0.15], [-0.3, 0.2, -0.15], [-0.3, -0.2, -0.15], [0.3, -0.2, -0.15]]
)  # mounts from the box's centre
PLACE = np.array([0.4, -0.3, 0.9])  # of the box's centre from the deck's own origin
ORIGIN = np.array([2.0, 1.0, 0.5])  # of the deck
LAW = {"roll": (3e4, 120.0), "shear": (2e4, 90.0), "axial": (5e4, 200.0)}  # N/m, N s/m


def text(*, weight=1.0):
    """Return a box on four mounts on a deck that is not at the world's origin and whose centre of mass is not its origin."""
    sites = "".join(f'<site name="b{i}" pos="{" ".join(map(str, PLACE + c))}"/>' for i, c in enumerate(CORNERS))
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    deck = (
        f'<body name="deck" pos="{" ".join(map(str, ORIGIN))}">{slides}<geom pos=".5 0 0" size=".1" mass="500"/>{sites}</body>'
    )
    ends = "".join(f'<site name="p{i}" pos="{" ".join(map(str, c))}"/>' for i, c in enumerate(CORNERS))
    box = (
        f'<body name="box" pos="{" ".join(map(str, ORIGIN + PLACE))}"><freejoint/><inertial pos="0 0 0" mass="{MASS}" '
        f'diaginertia="{" ".join(map(str, INERTIA))}"/>{ends}<site name="point/top" pos=".1 .1 .3"/></body>'
    )
    mounts = [(f"m{i}", f"p{i}", f"b{i}", "a") for i in range(4)]
    return mjcf(deck + box, mounts, gravity=GRAVITY * weight)


@cache
def boxed(scale=1.0, weight=1.0):
    laws = {axis: wr.KelvinVoigt(k=scale * k, c=math.sqrt(scale) * c) for axis, (k, c) in LAW.items()}
    system = wr.load_system(text(weight=weight), isolators={"a": wr.Isolator(name="a", **laws)})
    return wr.with_rotation(system)


def ship(**changes):
    """Return a motion in all six parts, angles of which are not small, about a point that is not the deck's origin."""
    parts = {
        "roll": (math.radians(25.0), 2.1), "pitch": (math.radians(14.0), 1.7), "yaw": (math.radians(18.0), 2.9),
        "heave": (0.2, 1.3), "sway": (0.1, 1.9), "position": (1.5, -0.8, 3.0), "ramp": 0.8,
    }  # fmt: skip
    return wr.ShipMotion(**{**parts, **changes})


def base_pose(motion, t):
    """Return origin, rotation and angular velocity of the deck as the world sees them, and its velocity."""
    roll, pitch, yaw = motion.angular_displacement([t])[0]
    turn = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
    return ORIGIN + motion.displacement([t])[0], turn, motion.angular_velocity([t])[0], motion.velocity([t])[0]


def base_motion(motion, t):
    """Return what `base_pose` does, and acceleration and angular acceleration of the deck."""
    return *base_pose(motion, t), motion.acceleration([t])[0], motion.angular_acceleration([t])[0]


@cache
def integrated(motion, times, start):
    """Integrate Newton's and Euler's equations of the box from a state: place (3), velocity, quaternion, angular velocity."""

    def rates(t, y):
        x, v, w = y[:3], y[3:6], y[10:]
        turn = Rotation.from_quat(y[6:10]).as_matrix()
        origin, deck, spin, speed = base_pose(motion, t)
        arms, there = CORNERS @ turn.T, origin + (PLACE + CORNERS) @ deck.T
        apart = (x + arms - there) @ deck
        spinning = np.array([[0.0, -spin[2], spin[1]], [spin[2], 0.0, -spin[0]], [-spin[1], spin[0], 0.0]])
        rate = (v + np.cross(turn @ w, arms) - speed - (x + arms - origin) @ spinning.T) @ deck
        pulls = (apart * [k for k, _ in LAW.values()] + rate * [c for _, c in LAW.values()]) @ deck.T
        force, torque = [0.0, 0.0, -MASS * GRAVITY] - pulls.sum(axis=0), -np.cross(arms, pulls).sum(axis=0)
        alpha = (turn.T @ torque - np.cross(w, INERTIA * w)) / INERTIA
        qx, qy, qz, qw = y[6:10]
        matrix = [[0, w[2], -w[1], w[0]], [-w[2], 0, w[0], w[1]], [w[1], -w[0], 0, w[2]], [-w[0], -w[1], -w[2], 0]]
        return np.concatenate([v, force / MASS, 0.5 * np.array(matrix) @ [qx, qy, qz, qw], alpha])

    done = solve_ivp(rates, (times[0], times[-1]), start, t_eval=times, method="DOP853", rtol=1e-9, atol=1e-11)
    return done.y.T, np.array([rates(t, y)[3:6] for t, y in zip(times, done.y.T, strict=True)])
