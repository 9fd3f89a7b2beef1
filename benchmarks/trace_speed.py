"""Speed of a trace: one million points per law, against SciPy's `solve_ivp` on the same path at equal error.

    python benchmarks/trace_speed.py

The path runs in cubics of one second from rest to rest between random turning points, 20 samples each, so that the cubic
through samples and rates, which is the path of a trace in time, is the path itself. Both contenders return force and
work at every sample. `solve_ivp` integrates the law's own compiled kernel and is restarted at every reversal, which spares it
the kink there. Of its methods and tolerances the cheapest is taken whose error, on twenty cubics, is not above 1e-8 of
the largest force and work, which every trace promises, or the trace's own if that is larger. Errors are counted against DOP853
at 1e-13 that is restarted where z is zero and where a slider begins to slip, too.

A trace is timed over the million, `solve_ivp` over a fiftieth of it, and that time is multiplied by fifty; for the laws named
by --full it runs over the whole million too.
"""

import argparse
from collections.abc import Callable
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt
from rounds import interleaved
from scipy.integrate import solve_ivp

from wirerope_mj.mounts.laws import LAWS, Law, registry

Array = npt.NDArray[np.float64]

POINTS = 1_000_000
PER_SEGMENT = 20
STRETCH = 50  # share of the path that solve_ivp is timed on, as its inverse
SEGMENTS = POINTS // PER_SEGMENT
CHECKED = 20  # cubics on which errors are counted
AMPLITUDE = 0.01  # of the turning points [m]
ERROR = 1e-8
TOLERANCES = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12]
PARAMETERS: dict[str, dict[str, object]] = {
    "bouc-wen": {"alpha": 1e5, "beta": 75.0, "gamma": 30.0, "n": 1.2, "k": 2e4},
    "ozdemir": {"alpha": 1e5, "beta": 300.0, "n": 1.0, "k": 2e4},
    "asymmetric-bouc-wen": {
        "alpha": 1e5, "beta": 150.0, "gamma": 30.0, "n": 1.0, "k1": 8e4, "k2": 1e5, "k3": 2e7, "b": 2.0, "c": 6.0,
    },
    "symmetric-bouc-wen": {"alpha": 1e5, "beta": 0.6, "gamma": -0.2, "n": 2.0, "k1": 8e4, "k2": 1e5, "k3": 2e7},
    "kelvin-voigt": {"k": 1e5, "c": 300.0},
    "enhanced-dry-friction": {"k": 5e4, "d": 300.0, "u_c": 3e-3},
    "masing": {"stiffness": [6e4, 4e4, 3e4], "slip_force": [60.0, 100.0, 200.0], "k": 2e4},
    "tinker-cutchins": {
        "k1": 8e4, "k2": 2e5, "k3": 2e7, "c": 200.0, "n": 1.5, "f0": 40.0, "f1": 2e3, "f2": 1e5, "smoothing": 2e-3,
    },
    "equivalent-viscous": {"k1": 8e4, "k2": 2e5, "k3": 2e7, "energy": 2.0, "amplitude": 0.01, "frequency": 0.5},
    "zener": {"k0": 5e4, "k1": 5e4, "c": 8000.0},
    "vaiana-rosati": {"kb": 3e4, "f0": 150.0, "alpha": 300.0, "b1": 20.0, "b2": 60.0, "g1": 15.0, "g2": 300.0},
    "bouc-wen-baber-noori": {
        "alpha": 1e5, "beta": 250.0, "gamma": 100.0, "n": 1.0, "k": 4e4, "delta_nu": 1e-4, "delta_eta": 1e-4,
        "zeta": 0.6, "q": 0.1, "p": 1e-2, "psi": 60.0, "lam": 0.5,
    },
}  # fmt: skip


class Found(NamedTuple):
    """Force [N] and work [J] at the samples, (n_t,) each."""

    force: Array
    work: Array


def turning_points(segments: int) -> Array:
    """Return the first turning points of the path [m], (segments + 1,), from zero to either side in turn."""
    ends = AMPLITUDE * np.random.default_rng(3).uniform(0.2, 1.0, SEGMENTS + 1)[: segments + 1]
    ends[::2] *= -1.0
    ends[0] = 0.0
    return ends


def sampled(ends: Array) -> tuple[Array, Array, Array]:
    """Return time [s], deflection [m] and rate [m/s] of the path, (n_t,) each."""
    u = np.arange(1, PER_SEGMENT + 1) / PER_SEGMENT
    rise = np.diff(ends)[:, None]
    x = ends[:-1, None] + rise * u * u * (3.0 - 2.0 * u)
    v = rise * 6.0 * u * (1.0 - u)
    time = np.arange(x.size + 1) / PER_SEGMENT
    return time, np.concatenate([ends[:1], x.ravel()]), np.concatenate([[0.0], v.ravel()])


@numba.njit
def rates(kernel, p, t, y, begin, rise, out):
    """Write the rates of the states and the power on the law to `out`."""
    n = y.size - 1
    x, v = begin + rise * t * t * (3.0 - 2.0 * t), rise * 6.0 * t * (1.0 - t)
    out[n] = v * registry.evaluate(kernel, p, 0, x, v, y, 0, out, 0)


@numba.njit
def forces(kernel, p, x, v, states):
    """Return the force at every sample."""
    out, unused = np.empty(x.size), np.empty(states.shape[1] + 1)
    for t in range(x.size):
        out[t] = registry.evaluate(kernel, p, 0, x[t], v[t], states[t], 0, unused, 0)
    return out


def traced(law: Law, samples: tuple[Array, Array, Array]) -> Found:
    time, x, v = samples
    loop = law.trace(x, time=time, rate=v)
    return Found(loop.force, loop.work)


def solved(law: Law, ends: Array, method: str, tolerance: float) -> Found:
    """Return what `solve_ivp` finds, restarted at every reversal."""
    n, y = law.n_states, np.zeros(law.n_states + 1)
    states, grid = [y[None, :]], np.arange(1, PER_SEGMENT + 1) / PER_SEGMENT
    for begin, end in zip(ends, ends[1:], strict=False):
        right_hand_side = equations(law, begin, end)
        run = solve_ivp(right_hand_side, (0.0, 1.0), y, method=method, t_eval=grid, rtol=tolerance, atol=tolerance * sizes(n))
        states.append(run.y.T)
        y = held(law, run.y[:, -1])
    return found(law, ends, np.concatenate(states))


def solved_closely(law: Law, ends: Array) -> Found:
    """Return the reference: restarted where z is zero and where a slider begins to slip, too."""
    n, y = law.n_states, np.zeros(law.n_states + 1)
    states, grid = [y[None, :]], np.arange(1, PER_SEGMENT + 1) / PER_SEGMENT
    for begin, end in zip(ends, ends[1:], strict=False):
        right_hand_side, at, s = equations(law, begin, end), 0.0, np.sign(end - begin)
        ahead = [(e, level) for e, level in kinks(law) if s * (y[e] - level) < 0.0]
        while at < 1.0:
            events = [crossing(e, level) for e, level in ahead]
            run = solve_ivp(
                right_hand_side, (at, 1.0), y, method="DOP853", rtol=1e-13, atol=1e-13 * sizes(n), events=events,
                dense_output=True,
            )  # fmt: skip
            inside = grid[(grid > at) & (grid <= run.t[-1])]
            if inside.size:
                states.append(run.sol(inside).T)
            at, y = run.t[-1], run.y[:, -1].copy()
            for (e, level), hits in zip(list(ahead), run.t_events or (), strict=True):
                if hits.size:
                    y[e] = level
                    ahead.remove((e, level))
        y = held(law, y)
    return found(law, ends, np.concatenate(states))


def held(law: Law, y: Array) -> Array:
    """Return the states at a reversal: Masing's kernel lets them grow elastically, its sliders hold them at their bounds."""
    slip = np.array(getattr(law, "slip_force", ()))
    return np.concatenate([np.clip(y[: slip.size], -slip, slip), y[slip.size :]])


def sizes(n: int) -> Array:
    """Return what relative errors are relative to near zero: 100 N of every state and 1 J, the size of a mount's."""
    return np.append(np.full(n, 100.0), 1.0)


def equations(law: Law, begin: float, end: float) -> Callable[[float, Array], Array]:
    """Return the rates of the states and the power on the law along one cubic, as SciPy calls them."""
    kernel, p, out = law.kernel, law.kernel_parameters(), np.zeros(law.n_states + 1)
    rise = end - begin

    def right_hand_side(t: float, y: Array) -> Array:
        rates(kernel, p, t, y, begin, rise, out)
        return out.copy()

    return right_hand_side


def found(law: Law, ends: Array, states: Array) -> Found:
    """Return force and work of states and work at the samples, (n_t, n_states + 1)."""
    _, x, v = sampled(ends)
    force = forces(law.kernel, law.kernel_parameters(), x, v, np.ascontiguousarray(states[:, :-1]))
    return Found(force, states[:, -1])


def kinks(law: Law) -> list[tuple[int, float]]:
    """Return the states and their values at which z changes its sign or a slider begins to slip."""
    sliders = [(e, s * h) for e, h in enumerate(getattr(law, "slip_force", ())) for s in (-1.0, 1.0)]
    return sliders or ([(0, 0.0)] if law.n_states else [])


def crossing(place: int, level: float) -> Callable[[float, Array], float]:
    """Return the event of a state that passes a level."""

    def event(_t: float, y: Array) -> float:
        return float(y[place] - level)

    event.terminal = True  # type: ignore[attr-defined]
    return event


def error(found: Found, reference: Found) -> float:
    """Return the largest error of force and work, each relative to its own largest value."""
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in zip(found, reference, strict=True))


def cheapest(law: Law, ends: Array, reference: Found, allowed: float) -> tuple[str, float, float]:
    """Return method, tolerance and error of the cheapest `solve_ivp` that errs by no more than `allowed`."""
    able: dict[tuple[str, float], float] = {}
    for method in ("LSODA", "RK45", "DOP853"):
        for tolerance in TOLERANCES:
            off = error(solved(law, ends, method, tolerance), reference)
            if off <= allowed:
                able[method, tolerance] = off
                break
    if not able:
        raise SystemExit(f"{law.name}: no method of solve_ivp comes within {allowed:.1e}.")
    work = {f"{m} {t}": lambda m=m, t=t: solved(law, ends, m, t) for m, t in able}
    costs = interleaved(work, rounds=3)
    method, tolerance = min(able, key=lambda key: costs[f"{key[0]} {key[1]}"])
    return method, tolerance, able[method, tolerance]


def report(name: str, *, rounds: int, full: bool) -> str:
    """Return the table's row of a law, or two."""
    law = LAWS[name](**PARAMETERS[name])
    short, stretch, whole = (turning_points(n) for n in (CHECKED, SEGMENTS // STRETCH, SEGMENTS))
    samples, reference = sampled(whole), solved_closely(law, short)
    own = error(traced(law, sampled(short)), reference)
    method, tolerance, theirs = cheapest(law, short, reference, max(own, ERROR))
    work = {"trace": lambda: traced(law, samples), "solve_ivp": lambda: solved(law, stretch, method, tolerance)}
    medians = interleaved(work, rounds=rounds)
    once, scaled = medians["trace"], STRETCH * medians["solve_ivp"]
    row = f"{name:22s}{once:10.3f} {scaled:14.1f} {scaled / once:7.0f} {own:15.1e} {theirs:13.1e}  {method} {tolerance:.0e}"
    if full:
        medians = interleaved({**work, "solve_ivp": lambda: solved(law, whole, method, tolerance)}, rounds=1)
        once, all_of_it = medians["trace"], medians["solve_ivp"]
        row += f"\n{'  not scaled':22s}{once:10.3f} {all_of_it:14.1f} {all_of_it / once:7.0f}"
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3, help="rounds whose median is taken (default 3)")
    parser.add_argument("--laws", nargs="*", default=sorted(LAWS), help="laws to measure (default: all)")
    parser.add_argument("--full", nargs="*", default=[], help="laws whose solve_ivp also runs over the million")
    arguments = parser.parse_args()
    rounds = arguments.rounds
    print(f"{POINTS} points; medians of {rounds} interleaved rounds; solve_ivp over 1/{STRETCH} of them, times {STRETCH}")
    print("law                    trace [s]  solve_ivp [s]   ratio  error of trace  of solve_ivp  method")
    for name in arguments.laws:
        print(report(name, rounds=rounds, full=name in arguments.full), flush=True)


if __name__ == "__main__":
    main()
