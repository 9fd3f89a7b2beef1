"""Problems drawn by chance, as tables for `newton_euler` and as models of the package.

One to three bodies of 1 kg to 3 t on each other, on four to six mounts each, upright or leaning, of laws, brackets and stops
drawn by chance, on a driven deck or on a frame that it carries on springs, under pulses or a random record.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from pathlib import Path

import numpy as np

import wirerope_mj as wr
from verification import newton_euler as ne
from verification.models import SLIDES, mjcf, mounts
from wirerope_mj.motions import BaseMotion
from wirerope_mj.mounts.laws import Law

Array = np.ndarray

AXES = ("roll", "shear", "axial")
ACCURACIES = (1e-3, 1e-4, 1e-4, 1e-5)  # asked for; 1e-4 is what `wr.simulate` takes by itself


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A problem for both: tables of the reference, and model, isolators and motion of the package."""

    seed: int
    words: str
    problem: ne.Problem
    text: str
    isolators: dict[str, wr.Isolator]
    duration: float
    accuracy: float


def _law(rng: np.random.Generator, stiffness: float, load: float, travel: float) -> tuple[Law, Array, str]:
    """Draw a law of about this stiffness [N/m] under this load [N], which moves by about `travel` [m]; its row and its name."""
    row = np.zeros(ne.COLUMNS)
    row[ne.BELOW : ne.ABOVE + 1], row[ne.EXPONENT], row[ne.REVERSAL] = np.inf, 1.0, 1.0
    name = rng.choice(["spring", "zener", "bouc-wen", "ni", "ni asymmetric", "two scales", "masing"])
    k = stiffness * rng.uniform(0.7, 1.3)
    z_max, x_y = load * 10.0 ** rng.uniform(-1.3, -0.3), travel * 10.0 ** rng.uniform(-1.7, -0.5)
    alpha, n, sigma = z_max / x_y, float(rng.choice([0.7, 1.0, 1.0, 1.5, 2.0, 3.0])), rng.uniform(0.5, 1.0)
    beta, gamma = sigma * alpha / z_max**n, (1.0 - sigma) * alpha / z_max**n
    hysteresis = {"alpha": alpha, "beta": beta, "gamma": gamma, "n": n}
    first, second = slice(ne.STATES, ne.STATES + 5), slice(ne.STATES + 5, ne.STATES + 10)
    k2, k3 = k * rng.uniform(0.0, 0.5) / travel, k * rng.uniform(0.0, 1.0) / travel**2
    if name == "spring":
        row[ne.K1], row[ne.C] = k, k / 30.0 * rng.uniform(0.05, 0.3)
        return wr.KelvinVoigt(k=k, c=row[ne.C]), row, name
    if name == "zener":
        k1, c = k * rng.uniform(0.3, 2.0), k / 30.0 * rng.uniform(0.2, 1.0)
        row[ne.K1], row[first] = k, [ne.MAXWELL, k1, k1 / c, 0.0, 0.0]
        return wr.Zener(k0=k, k1=k1, c=c), row, name
    if name == "masing":
        slip = [0.4 * z_max, 0.6 * z_max]
        row[ne.K1], row[ne.K3] = k, k3
        row[first], row[second] = [ne.JENKIN, alpha, slip[0], 0.0, 0.0], [ne.JENKIN, 0.3 * alpha, slip[1], 0.0, 0.0]
        return wr.Masing(stiffness=[alpha, 0.3 * alpha], slip_force=slip, k=k, k3=k3), row, name
    row[ne.K1], row[first] = k, [ne.BOUC_WEN, *hysteresis.values()]
    if name == "bouc-wen":
        return wr.BoucWen(**hysteresis, k=k), row, name
    row[ne.K2], row[ne.K3] = k2, k3
    if name == "ni":
        return wr.SymmetricBoucWen(**hysteresis, k1=k, k2=k2, k3=k3), row, name
    b, c = 2.0, rng.uniform(-0.7, 0.7) / travel
    row[ne.LAM] = c * np.log(b)
    law: Law = wr.AsymmetricBoucWen(**hysteresis, k1=k, k2=k2, k3=k3, b=b, c=c)
    if name == "two scales":
        fine = {"alpha": 0.4 * alpha, "beta": 0.4 * alpha * 8.0 / z_max, "gamma": 0.0, "n": 1.0}
        row[second] = [ne.BOUC_WEN, *fine.values()]
        law = wr.Parallel(laws=(law, wr.BoucWen(**fine)))
    return law, row, str(name)


def _frame_axes(rng: np.random.Generator) -> Array:
    """Draw the axes of a mount: upright four times of five, else leaning by up to 60 degrees; turned about the vertical."""
    turn, lean = rng.uniform(0.0, 2.0 * np.pi), 0.0 if rng.random() < 0.8 else rng.uniform(0.1, 1.05)
    c, s, a, b = np.cos(turn), np.sin(turn), np.cos(lean), np.sin(lean)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array([[a, 0.0, b], [0.0, 1.0, 0.0], [-b, 0.0, a]])


def _motion_tables(rng: np.random.Generator, change: float) -> tuple[str, float, Array, tuple[float, Array]]:
    """Draw pulses that change the velocity by `change` [m/s], or a random record: kind, end [s], and `Problem`'s tables."""
    pulses, record = np.zeros((0, 6)), (1.0, np.zeros((0, 3)))
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    start, length = 0.01 + 0.1 * rng.random(), 10.0 ** rng.uniform(-2.5, -1.5)
    kind = str(rng.choice(["half-sine", "sawtooth", "double pulse", "random"]))
    over = start + length
    if kind in ("half-sine", "sawtooth"):
        sawtooth = float(kind == "sawtooth")
        peak = change / length * (2.0 if sawtooth else np.pi / 2.0)
        pulses = np.array([[sawtooth, start, length, *(peak * direction)]])
    elif kind == "double pulse":
        peak, second = change / length * np.pi / 2.0, length * rng.uniform(1.5, 4.0)
        pulses = np.array(
            [[0.0, start, length, *(peak * direction)], [0.0, over, second, *(-peak * length / second * direction)]]
        )
        over += second
    else:
        over, rate = 0.8, 2000.0
        time = np.arange(int(over * rate) + 1) / rate
        lines, phases = rng.uniform(5.0, 120.0, (40, 1)), rng.uniform(0.0, 2.0 * np.pi, (3, 40, 1))
        window = np.sin(np.pi * np.minimum(time / over, 1.0)) ** 2
        samples = np.sin(2.0 * np.pi * lines * time + phases).sum(axis=1) * window
        record = (rate, np.ascontiguousarray((samples * rng.uniform(2.0, 15.0) / samples.std()).T))
    return kind, over, pulses, record


def draw(seed: int, *, stopped: bool) -> Drawn:
    """Draw a problem; with `stopped` every payload has stops, which the reference strikes."""
    rng = np.random.default_rng(seed)
    count = int(rng.choice([1, 1, 2, 3]))
    masses = 10.0 ** rng.uniform(0.0, 3.5) * np.concatenate([[1.0], rng.uniform(0.1, 0.5, count - 1)])
    sizes = 0.08 * np.cbrt(masses)  # half an edge: a density of a quarter of water's
    masses_above = masses.copy()
    lower = [ne.FRAME if rng.random() < 0.35 else ne.BASE]
    lower += [int(rng.integers(-1, i)) if rng.random() < 0.7 else i - 1 for i in range(1, count)]
    lower = [lower[0] if foot == -1 and i else foot for i, foot in enumerate(lower)]
    for i in range(count - 1, 0, -1):
        if lower[i] >= 0:
            masses_above[lower[i]] += masses_above[i]
    edges = np.array([sizes[i] * rng.uniform(0.6, 1.4, 3) for i in range(count)])
    centres = np.empty((count, 3))
    points, axes, ends, laws, names, words = [], [], [], [], [], Counter[str]()
    isolators: dict[str, wr.Isolator] = {}
    change = rng.uniform(0.2, 1.5)  # of the base's velocity [m/s]
    for i in range(count):
        foot = lower[i]
        below = np.array([1.5 * i * sizes[0] * 3.0, 0.0, 0.4]) if foot < 0 else centres[foot] + [0.0, 0.0, edges[foot][2]]
        centres[i] = below + [0.0, 0.0, edges[i][2] + 0.1 * sizes[i]] + rng.uniform(-0.15, 0.15, 3) * edges[i]
        each = int(rng.integers(4, 7))
        frequency = rng.uniform(4.0, 12.0)
        omega, load = 2.0 * np.pi * frequency, masses_above[i] * ne.GRAVITY / each
        travel = max(change / omega, ne.GRAVITY / omega**2)
        corners = [(1, 1), (1, -1), (-1, 1), (-1, -1), (0, 1), (1, 0)][:each]
        for number, corner in enumerate(corners):
            made: dict[str, Law] = {}
            rows, bracket = [], {}
            for axis, softer in zip(AXES, (rng.uniform(0.4, 1.0), rng.uniform(0.4, 1.0), 1.0), strict=True):
                law, row, name = _law(rng, softer * masses_above[i] * omega**2 / each, load, travel)
                if rng.random() < 0.1 and name in ("spring", "bouc-wen", "ni", "ni asymmetric", "two scales"):
                    row[ne.BRACKET] = bracket[axis] = rng.uniform(3.0, 15.0) * masses_above[i] * omega**2 / each
                    name += " on a bracket"
                made[axis] = law
                rows.append(row)
                words[name] += 1
            name = f"b{i}m{number}"
            isolators[name] = wr.Isolator(
                name=name,
                roll=made["roll"],
                shear=made["shear"],
                axial=made["axial"],
                bracket=wr.Bracket(**bracket) if bracket else None,
            )
            names.append(name)
            ends.append((i, foot))
            laws.append(rows)
            axes.append(_frame_axes(rng))
            points.append(centres[i] + [*(0.9 * edges[i][:2] * corner), -edges[i][2]])
    frame = np.zeros(7)
    if lower[0] == ne.FRAME:
        natural, heavy = 2.0 * np.pi * rng.uniform(8.0, 30.0, 3), masses.sum() * 10.0 ** rng.uniform(-0.5, 1.0)
        frame = np.concatenate([[heavy], heavy * natural**2, 2.0 * rng.uniform(0.01, 0.06) * heavy * natural])
    kind, over, pulses, record = _motion_tables(rng, change)
    problem = ne.Problem(
        masses=masses, inertias=np.array([masses[i] / 3.0 * (np.sum(e**2) - e**2) for i, e in enumerate(edges)]),
        centres=centres, frame=frame, points=np.array(points), axes=np.array(axes), ends=np.array(ends, dtype=np.int64),
        laws=np.array(laws), pulses=pulses, record=record,
    )  # fmt: skip
    duration = float(np.ceil(1e3 * (over + 0.5)) / 1e3)
    if stopped:
        problem, isolators = _with_stops(rng, problem, names, isolators, duration)
    said = ", ".join([
        f"{count} bodies from {masses[0]:.3g} kg", f"{len(names)} mounts", "frame" if frame[0] else "base", kind,
        *(["stops"] if stopped else []), *(f"{number} {name}" for name, number in sorted(words.items())),
    ])  # fmt: skip
    return Drawn(
        seed=seed, words=said, problem=problem, text=_mjcf(problem, names), isolators=isolators, duration=duration,
        accuracy=float(rng.choice(ACCURACIES)),
    )  # fmt: skip


def _with_stops(
    rng: np.random.Generator, problem: ne.Problem, names: Sequence[str], isolators: dict[str, wr.Isolator], duration: float
) -> tuple[ne.Problem, dict[str, wr.Isolator]]:
    """Give half of the mounts a stop along their axis, at a part of the way that they would go without."""
    free = ne.solve(problem, np.array([0.0, duration]), 1e-6)
    bodies, laws, changed = problem.masses.size, problem.laws.copy(), dict(isolators)
    for m, name in enumerate(names):
        if m and rng.random() < 0.5:
            continue
        low, high = free.minimum[bodies + m, 2], free.maximum[bodies + m, 2]
        force = np.abs(free.largest[bodies + len(names) + m])
        soft = force / max(-low, high)
        given = {"gap_below": -low * rng.uniform(0.5, 0.85)}
        if high > 0.1 * -low and rng.random() < 0.5:
            given["gap_above"] = high * rng.uniform(0.5, 0.85)
        given |= {"k": soft * rng.uniform(3.0, 30.0)}
        if rng.random() < 0.6:
            given["rounding"] = -low * rng.uniform(0.02, 0.2)
            if rng.random() < 0.5:
                given["c"] = 0.3 * np.sqrt(given["k"] * problem.masses[problem.ends[m][0]])
        if rng.random() < 0.5:
            given |= {"loss": rng.uniform(0.1, 0.6), "reversal": -low * rng.uniform(0.01, 0.05)}
        stop, row = wr.Stop(**given), laws[m, 2]
        for column, key in (
            (ne.BELOW, "gap_below"), (ne.ABOVE, "gap_above"), (ne.STIFF, "k"), (ne.ROUNDING, "rounding"), (ne.LOSS, "loss"),
            (ne.REVERSAL, "reversal"), (ne.VISCOUS, "c"),
        ):  # fmt: skip
            row[column] = given.get(key, row[column])
        if row[ne.BRACKET]:  # a stop stands beside the bracket, where a law of an isolator would stand on it
            row[ne.BRACKET] = 0.0
            bracket = changed[name].bracket
            others = {axis: value for axis, value in bracket.stated.items() if axis != "axial"} if bracket else {}
            changed[name] = replace(changed[name], bracket=wr.Bracket(**others) if others else None)
        law = changed[name].axial
        parts = law.laws if isinstance(law, wr.Parallel) else (law,)
        changed[name] = replace(changed[name], axial=wr.Parallel(laws=(*parts, stop)))
    return replace(problem, laws=laws), changed


def _numbers(values: Sequence[float] | Array) -> str:
    return " ".join(f"{value:.17g}" for value in values)


def _mjcf(problem: ne.Problem, names: Sequence[str]) -> str:
    """Write the problem as a model."""
    sites: dict[int, list[str]] = {foot: [] for foot in range(-2, problem.masses.size)}
    for m, (payload, foot) in enumerate(problem.ends.tolist()):
        turned = f'xyaxes="{_numbers([*problem.axes[m][:, 0], *problem.axes[m][:, 1]])}"'
        for body, letter in ((payload, "p"), (foot, "f")):
            place = problem.points[m] - (problem.centres[body] if body >= 0 else 0.0)
            sites[body].append(f'<site name="{letter}{m}" pos="{_numbers(place)}" {turned}/>')
    slides = "".join(f'<joint name="base_{a}" type="slide" axis="{v}"/>' for a, v in SLIDES.items())
    inner = ""
    if problem.frame[0]:
        stiffness, damping = problem.frame[1:4], problem.frame[4:7]
        springs = "".join(
            f'<joint name="frame_{a}" type="slide" axis="{v}" stiffness="{k:.17g}" damping="{c:.17g}"/>'
            for (a, v), k, c in zip(SLIDES.items(), stiffness, damping, strict=True)
        )
        inner = (
            f'<body name="frame">{springs}<inertial pos="0 0 0" mass="{problem.frame[0]:.17g}" diaginertia="1 1 1"/>'
            f"{''.join(sites[ne.FRAME])}</body>"
        )
    world = f'<body name="base">{slides}<geom size=".1" mass="5"/>{"".join(sites[ne.BASE])}{inner}</body>'
    for b, centre in enumerate(problem.centres):
        world += (
            f'<body name="body{b}" pos="{_numbers(centre)}"><freejoint/><inertial pos="0 0 0" '
            f'mass="{problem.masses[b]:.17g}" diaginertia="{_numbers(problem.inertias[b])}"/>{"".join(sites[b])}</body>'
        )
    pairs = [(name, f"p{m}", f"f{m}", name) for m, name in enumerate(names)]
    base = '<tuple name="base"><element objtype="body" objname="base"/></tuple>'
    return mjcf(world, custom=base + mounts(pairs), gravity=ne.GRAVITY)


def motion_of(problem: ne.Problem, folder: Path) -> BaseMotion:
    """Make the package's motion of the tables; a record goes through a file."""
    rate, samples = problem.record
    if len(samples):
        path = folder / "record.csv"
        lines = [f"{i / rate:.17g},{_numbers(row).replace(' ', ',')}" for i, row in enumerate(samples)]
        path.write_text("\n".join(["time [s],x [m/s^2],y [m/s^2],z [m/s^2]", *lines]), encoding="utf-8")
        return wr.load_record(path)
    pulses: list[BaseMotion] = []
    for sawtooth, start, duration, *peak in problem.pulses.tolist():
        size = float(np.linalg.norm(peak))
        x, y, z = (value / size for value in peak)
        pulse = wr.Sawtooth if sawtooth else wr.HalfSine
        pulses.append(pulse(peak=size, duration=duration, start=start, direction=(x, y, z)))
    return reduce(add, pulses)
