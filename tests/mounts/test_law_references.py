"""Traces against independent solutions: increments written by hand, and integrations split at every kink.

Nothing of the references comes from the library. Paths are random turning points with samples between them; all have units
of one unless they say otherwise.
"""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from laws_for_tests import path_through, smooth_path
from scipy.integrate import quad, solve_ivp

from wirerope_mj.mounts import laws

pytestmark = pytest.mark.quick

RNG = np.random.default_rng(20)
POINTS = [RNG.uniform(-2.0, 2.0, 12) for _ in range(4)]


def by_events(rates, path, *, size):
    """Return states at every sample of `path`, (n_t, size), integrated by DOP853 at 1e-12 and split where z = y[0] is 0.

    `rates(s, up, x, y)` is dy/dl over the length l of a segment of direction s; `up` = +-1 is the sign of s z, a constant
    between two splits.
    """
    y, out = np.zeros(size), [np.zeros(size)]
    for x0, x1 in zip(path, path[1:], strict=False):
        s, at, whole = np.sign(x1 - x0), 0.0, abs(x1 - x0)
        up = 1.0 if s * y[0] >= 0.0 else -1.0
        while at < whole:

            def right_hand_side(length, y, s=s, up=up, x0=x0):
                return rates(s, up, x0 + s * length, y)

            def crossing(_l, y):
                return y[0]

            crossing.terminal, crossing.direction = True, s if up < 0.0 else 0.5
            events = crossing if up < 0.0 else None
            run = solve_ivp(right_hand_side, (at, whole), y, method="DOP853", rtol=1e-12, atol=1e-14, events=events)
            assert run.success, run.message
            at, y = run.t[-1], run.y[:, -1].copy()
            if up < 0.0 and run.t_events[0].size:
                y[0], up = 0.0, 1.0
        out.append(y.copy())
    return np.array(out)


def bouc_wen_rates(*, alpha, beta, gamma, n, force=lambda x, z: z):
    """Return dz/dl and dW/dl of Bouc-Wen's equation with an own force."""

    def rates(s, up, x, y):
        return [s * (alpha - (gamma + beta * up) * abs(y[0]) ** n), s * force(x, y[0])]

    return rates


BOUC_WEN = [
    {"alpha": 2.0, "beta": 0.8, "gamma": 0.2, "n": 1.0},
    {"alpha": 2.0, "beta": 0.8, "gamma": 0.2, "n": 2.0},
    {"alpha": 1.0, "beta": 0.5, "gamma": -0.5, "n": 1.0},
    {"alpha": 1.0, "beta": 0.5, "gamma": 0.5, "n": 2.0},
    {"alpha": 1.0, "beta": 0.3, "gamma": 0.9, "n": 1.0},
    {"alpha": 1.0, "beta": 0.3, "gamma": 0.9, "n": 2.0},
    {"alpha": 1.5, "beta": 0.7, "gamma": 0.1, "n": 0.4},
    {"alpha": 1.5, "beta": 0.7, "gamma": 0.1, "n": 1.3},
    {"alpha": 1.5, "beta": 0.7, "gamma": -0.3, "n": 3.5},
]


@pytest.mark.parametrize("parameters", BOUC_WEN, ids=str)
def test_bouc_wen_is_its_differential_equation(parameters):
    exact = parameters["n"] in (1.0, 2.0)
    for points in POINTS:
        path = path_through(points, per_segment=3)
        expected = by_events(bouc_wen_rates(**parameters), path, size=2)
        trace = laws.BoucWen(**parameters).trace(path)
        # The closed forms leave what DOP853 at 1e-12 leaves over 36 segments; for n < 1 the slope at z = 0 is vertical
        # in its derivative and costs both integrations.
        tolerance = 1e-11 if exact else 1e-8 if parameters["n"] < 1.0 else 1e-9
        np.testing.assert_allclose(trace.hysteretic_state, expected[:, 0], rtol=0, atol=tolerance)
        # Gauss' rule with four points: 3e-10 for n = 2, whose tangents are no exponentials.
        np.testing.assert_allclose(trace.work, expected[:, 1], rtol=0, atol=max(tolerance, 1e-9))


# Points and weights of a quadrature over 0 to 1 in 32 panels that narrow towards 1, where a state nears its bound.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_REST = 1.0 - ((np.arange(32)[:, None] + 0.5 * (1.0 + _POINTS)) / 32.0).ravel()
UNIT, SHARES = 1.0 - _REST**3, 3.0 * _REST**2 * np.tile(_WEIGHTS, 32) / 64.0


@pytest.mark.parametrize("n", ["1/20", "1/3", "1/2", "9/10", "13/10", "5/2", "8", "30", "100"])
@pytest.mark.parametrize("asymmetry", [0.0, 0.6])
@pytest.mark.parametrize(("bound", "reached"), [(1.0, (0.9, 0.6)), (8.0, (0.3, 0.25))], ids=["far", "near zero"])
def test_work_at_any_exponent_is_the_integral_over_the_root_of_the_state(n, asymmetry, bound, reached):
    """With n = p / q the length and the work are integrals of rational functions of the q-th root v of the state's size.

    The path loads, unloads to z = 0 and loads the other way; the whole of each is one segment.
    """
    p, q = Fraction(n).as_integer_ratio()
    bend = bound ** (-p / q)
    given = {"alpha": 1.0, "beta": 0.9 * bend, "gamma": 0.1 * bend, "n": p / q, "k1": 0.2, "k2": 0.0, "k3": 1.0}
    law = laws.AsymmetricBoucWen(**given, b=math.exp(0.5), c=2.0 * asymmetry)

    def per_root(v, b):
        return q * v ** (q - 1) / (1.0 - b * v**p)

    def branch(x0, side, b, start, end):
        """Return length and work of a branch on which the state's size goes from one end to the other, of which one is zero."""
        largest = max(start, end) ** (1.0 / q)
        v, grows = largest * UNIT, start == 0.0
        length = v * (per_root(v[:, None] * UNIT, b) @ SHARES)
        whole = largest * float(per_root(v, b) @ SHARES)
        x = x0 + side * (length if grows else whole - length)
        force = np.exp(asymmetry * x) * (side * (1.0 if grows else -1.0) * v**q + 0.2 * x + x**3)
        return whole, side * largest * float((force * per_root(v, b)) @ SHARES)

    most, least = (bound * share ** (q / p) for share in reached)
    path, work = [0.0], [0.0]
    for side, b, start, end in ((1.0, bend, 0.0, most), (-1.0, -0.8 * bend, most, 0.0), (-1.0, bend, 0.0, least)):
        length, done = branch(path[-1], side, b, start, end)
        path, work = [*path, path[-1] + side * length], [*work, work[-1] + done]
    loop = law.trace(path)
    # At n = 100 what q = z^n takes from one gains a hundred roundings, and the state's rate with it.
    np.testing.assert_allclose(loop.hysteretic_state, [0.0, most, 0.0, -least], rtol=0, atol=1e-13 * most)
    # Eight points of what F2 adds to the work: 4e-12 at the most.
    scale = np.abs(loop.force).max() * np.abs(np.diff(path)).sum()
    np.testing.assert_allclose(loop.work, work, rtol=0, atol=1e-11 * scale)


def test_a_state_at_its_bound_stays_there_however_long_the_path_is():
    """Millions of yield deflections are a few steps, not more than a trace takes."""
    law = laws.BoucWen(alpha=0.96, beta=0.97, gamma=0.9, n=0.05)
    loop = law.trace([0.0, 3.0, -3.0])
    np.testing.assert_allclose(loop.force, [0.0, law.z_max, -law.z_max], rtol=1e-12)  # 20 times what rounding leaves of q
    # But for 4e-5 m at each turn, over which z gets there: z_max / (alpha n).
    assert loop.work[-1] == pytest.approx(9.0 * law.z_max, rel=3 * 4e-5 / 9.0)


@pytest.mark.parametrize("parameters", [p for p in BOUC_WEN if p["n"] == 1.0], ids=str)
def test_n_1_follows_the_exponentials_written_by_hand(parameters):
    alpha, beta, gamma = (parameters[key] for key in ("alpha", "beta", "gamma"))

    def loading(y, length):
        total = beta + gamma
        return y + alpha * length if total == 0.0 else alpha / total + (y - alpha / total) * math.exp(-total * length)

    def unloading(w, length):
        difference = beta - gamma
        if difference == 0.0:
            return w - alpha * length, w / alpha
        q = alpha / difference
        return (w + q) * math.exp(-difference * length) - q, math.log1p(w / q) / difference

    for points in POINTS:
        path, z = path_through(points, per_segment=2), [0.0]
        for x0, x1 in zip(path, path[1:], strict=False):
            s, y, length = math.copysign(1.0, x1 - x0), math.copysign(1.0, x1 - x0) * z[-1], abs(x1 - x0)
            if y < 0.0:
                w, zero = unloading(-y, length)
                y, length = (-w, 0.0) if length < zero else (0.0, length - zero)
            z.append(s * loading(y, length))
        # Rounding of 24 exponentials.
        np.testing.assert_allclose(laws.BoucWen(**parameters).trace(path).force, z, rtol=0, atol=1e-13)


@pytest.mark.parametrize(
    "lengths",
    [
        10.0,
        1e3,
        1e5,
    ],
)
def test_work_of_one_long_segment_is_exact(lengths):
    """However many times a segment is longer than the law's memory, its work is the integral of the exponential."""
    law = laws.BoucWen(alpha=2.0, beta=0.8, gamma=0.2, n=1)
    bound = 2.0
    expected = bound * lengths + bound * math.expm1(-lengths)
    assert law.trace([0.0, lengths]).work[-1] == pytest.approx(expected, rel=1e-11)


def test_ni_is_its_differential_equation():
    hysteresis = {"alpha": 2.0, "beta": 0.7, "gamma": 0.3}
    k1, k2, k3, b, c = 0.5, 0.2, 0.3, 2.0, 0.4

    def force(x, z):
        return b ** (c * x) * (z + k1 * x + k2 * math.copysign(x * x, x) + k3 * x**3)

    for n, points in ((1.0, POINTS[0]), (2.0, POINTS[1]), (1.5, POINTS[2])):
        path = path_through(points, per_segment=3)
        expected = by_events(bouc_wen_rates(**hysteresis, n=n, force=force), path, size=2)
        trace = laws.AsymmetricBoucWen(**hysteresis, n=n, k1=k1, k2=k2, k3=k3, b=b, c=c).trace(path)
        # As for Bouc-Wen; k2 |x| x has a kink in its slope at x = 0, which the reference meets with short steps.
        np.testing.assert_allclose(trace.hysteretic_state, expected[:, 0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(trace.work, expected[:, 1], rtol=0, atol=1e-8)
        np.testing.assert_allclose(
            trace.force, [force(x, z) for x, z in zip(path, expected[:, 0], strict=True)], rtol=0, atol=1e-8
        )


def test_dry_friction_with_a_reversal_length_follows_tno_from_reversal_to_reversal():
    k, d, u_c = 0.7, 1.3, 0.4
    law = laws.EnhancedDryFriction(k=k, d=d, u_c=u_c)
    for points in POINTS:
        # Between reversals the printed form is applied once, however many samples lie there.
        path, friction, start, expected = path_through(points, per_segment=5), 0.0, 0.0, [0.0]
        for end in points:
            s = math.copysign(1.0, end - start)
            for u in np.linspace(start, end, 6)[1:]:
                expected.append(k * u + s * d + (friction - s * d) * math.exp(-abs(u - start) / u_c))
            friction, start = expected[-1] - k * end, end
        # A turning point that is passed through is no reversal: the exponential goes on, equal to rounding.
        np.testing.assert_allclose(law.trace(path).force, expected, rtol=0, atol=1e-13)


def test_masing_is_its_elements_one_by_one():
    stiffness, slip, k, k2, k3 = [2.0, 1.0, 0.5], [0.4, 0.7, 0.9], 0.3, 0.2, 0.1
    law = laws.Masing(stiffness=stiffness, slip_force=slip, k=k, k2=k2, k3=k3)
    for points in POINTS:
        path, f, work = path_through(points, per_segment=4), np.zeros(3), 0.0
        history, works = [f.copy()], [0.0]
        for x0, x1 in zip(path, path[1:], strict=False):
            for i, (c, h) in enumerate(zip(stiffness, slip, strict=True)):
                trial = f[i] + c * (x1 - x0)
                end = min(max(trial, -h), h)
                stretched = (end - f[i]) / c
                work += (end * end - f[i] * f[i]) / (2.0 * c) + end * (x1 - x0 - stretched)
                f[i] = end
            history.append(f.copy())
            works.append(work + k * x1**2 / 2.0 + k2 * abs(x1) ** 3 / 3.0 + k3 * x1**4 / 4.0)
        trace = law.trace(path)
        expected = np.array(history)
        # Additions only.
        np.testing.assert_allclose(trace.internal_states, expected, rtol=0, atol=1e-14)
        np.testing.assert_allclose(trace.hysteretic_state, expected.sum(axis=1), rtol=0, atol=1e-14)
        spring = k * path + k2 * np.abs(path) * path + k3 * path**3
        np.testing.assert_allclose(trace.force, spring + expected.sum(axis=1), rtol=0, atol=1e-13)
        np.testing.assert_allclose(trace.work, works, rtol=0, atol=1e-12)


def limit(u, *, b1, b2, g1, g2, g3):
    """Return Vaiana and Rosati's fe(u)."""
    return b1 * math.exp(b2 * u) - b1 + 4.0 * g1 / (1.0 + math.exp(-g2 * (u - g3))) - 2.0 * g1


UP = {"b1": 0.2, "b2": 0.8, "g1": 0.3, "g2": 2.0, "g3": 0.1}
DOWN = {"b1": 0.1, "b2": 0.5, "g1": 0.2, "g2": 1.5, "g3": -0.2}
UP_LINEAR = {"kb": 0.4, "f0": 1.1, "alpha": 2.5}
DOWN_LINEAR = {"kb": 0.3, "f0": 0.8, "alpha": 1.7}


@pytest.mark.parametrize("different", [False, True])
def test_vaiana_rosati_is_its_algebraic_form(different):
    down, down_linear = (DOWN, DOWN_LINEAR) if different else (UP, UP_LINEAR)
    minus = {f"{key}_minus": value for key, value in {**down, **down_linear}.items()} if different else {}
    law = laws.VaianaRosati(**UP, **UP_LINEAR, **minus)

    def curve(u, s):
        shape, linear = (UP, UP_LINEAR) if s > 0.0 else (down, down_linear)
        return limit(u, **shape) + linear["kb"] * u + s * linear["f0"]

    mean = 0.5 * (curve(0.0, 1.0) + curve(0.0, -1.0))  # the house's curves are shifted so that this is zero

    def force(u, u_p, f_p):
        s = math.copysign(1.0, u - u_p)
        decay = (UP_LINEAR if s > 0.0 else down_linear)["alpha"]
        return curve(u, s) - mean - (curve(u_p, s) - mean - f_p) * math.exp(-decay * abs(u - u_p))

    for points in POINTS:
        path, start, f_start, done = path_through(points, per_segment=4), 0.0, 0.0, 0.0
        expected, work = [0.0], [0.0]
        for end in points:
            for u in np.linspace(start, end, 5)[1:]:
                expected.append(force(u, start, f_start))
                area, _ = quad(force, start, u, args=(start, f_start), epsabs=1e-13, epsrel=1e-13)
                work.append(done + area)
            f_start, start, done = expected[-1], end, work[-1]
        trace = law.trace(path)
        # Exponentials and sums of a few units.
        np.testing.assert_allclose(trace.force, expected, rtol=0, atol=1e-12)
        np.testing.assert_allclose(trace.work, work, rtol=0, atol=1e-11)


def test_baber_noori_is_its_two_differential_equations():
    p = {"alpha": 2.0, "beta": 0.7, "gamma": 0.3, "delta_alpha": 0.03, "delta_nu": 0.05, "delta_eta": 0.04}
    q = {"zeta": 0.7, "q": 0.15, "p": 0.6, "psi": 0.3, "delta_psi": 0.02, "lam": 0.4}
    k = 0.5
    for n, points in ((1.0, POINTS[0]), (2.0, POINTS[1]), (1.4, POINTS[2])):

        def rates(s, up, x, y, n=n):
            z, e = y[0], y[1]
            big_a = p["alpha"] - p["delta_alpha"] * e
            nu, eta = 1.0 + p["delta_nu"] * e, 1.0 + p["delta_eta"] * e
            slip = q["zeta"] * (1.0 - math.exp(-q["p"] * e))
            width = (q["psi"] + q["delta_psi"] * e) * (q["lam"] + slip)
            bound = (big_a / (nu * (p["beta"] + p["gamma"]))) ** (1.0 / n)
            h = 1.0 - slip * math.exp(-(((z * s - q["q"] * bound) / width) ** 2))
            slope = h / eta * (big_a - nu * (p["beta"] * up + p["gamma"]) * abs(z) ** n)
            return [s * slope, s * z, s * (k * x + z)]

        path = path_through(points, per_segment=3)
        expected = by_events(rates, path, size=3)
        trace = laws.BoucWenBaberNoori(**p, **q, n=n, k=k).trace(path)
        # Both integrations are held to 1e-11 and 1e-12 a step over 36 segments.
        np.testing.assert_allclose(trace.internal_states, expected[:, :2], rtol=0, atol=1e-9)
        np.testing.assert_allclose(trace.work, expected[:, 2], rtol=0, atol=1e-8)
        np.testing.assert_allclose(trace.force, k * path + expected[:, 0], rtol=0, atol=1e-9)


def test_zener_is_its_differential_equation_along_a_smooth_path():
    k0, k1, c = 0.6, 1.4, 0.5
    points = POINTS[0][:6]
    x, time, rate = smooth_path(points, per_segment=400)
    z, expected, work, works = 0.0, [0.0], 0.0, [0.0]
    for i, (a, b) in enumerate(zip([0.0, *points], points, strict=False)):

        def right_hand_side(t, y, a=a, b=b):
            u, v = (
                0.5 * (a + b) - 0.5 * (b - a) * math.cos(math.pi * t),
                0.5 * math.pi * (b - a) * math.sin(math.pi * t),
            )
            return [k1 * v - k1 / c * y[0], (k0 * u + y[0]) * v]

        inside = np.arange(1, 401) / 400
        run = solve_ivp(right_hand_side, (0.0, 1.0), [z, work], method="DOP853", rtol=1e-12, atol=1e-14, t_eval=inside)
        assert run.success, (i, run.message)
        expected.extend(run.y[0])
        works.extend(run.y[1])
        z, work = run.y[0, -1], run.y[1, -1]
    trace = laws.Zener(k0=k0, k1=k1, c=c).trace(x, time=time, rate=rate)
    # The cubics between samples err by (pi / 400)^4 / 384 = 1e-11 of the path, 400 times steeper in the rate.
    np.testing.assert_allclose(trace.force, k0 * x + np.array(expected), rtol=0, atol=1e-9)
    np.testing.assert_allclose(trace.work, works, rtol=0, atol=1e-9)


def rate_dependent():
    """Return laws without a state of their own and their forces written out, as functions of x and v."""
    friction = laws.TinkerCutchins(
        k1=1.0, k2=0.3, k3=0.4, c=0.6, n=1.5, f0=0.3, f1=0.2, f2=0.1, smoothing=0.2
    )  # fmt: skip
    viscous = laws.EquivalentViscous(k1=1.0, k2=0.3, k3=0.4, energy=0.9, amplitude=1.2, frequency=0.5)
    c = 0.9 / (math.pi * 2.0 * math.pi * 0.5 * 1.2**2)
    return [
        (laws.KelvinVoigt(k=1.3, c=0.4), lambda x, v: 1.3 * x + 0.4 * v),
        (
            friction,
            lambda x, v: x + 0.3 * x**2 + 0.4 * x**3 + 0.6 * np.abs(v) ** 1.5 * np.sign(v)
            + (0.3 + 0.2 * np.abs(x) + 0.1 * x**2) * np.tanh(v / 0.2),
        ),
        (viscous, lambda x, v: x + 0.3 * x**2 + 0.4 * x**3 + c * v),
    ]  # fmt: skip


@pytest.mark.parametrize("number", range(3), ids=["kelvin-voigt", "tinker-cutchins", "equivalent-viscous"])
def test_rate_dependent_force_is_its_equation_and_its_work_the_integral(number):
    law, force = rate_dependent()[number]
    points = POINTS[1][:6]
    x, time, rate = smooth_path(points, per_segment=400)
    trace = law.trace(x, time=time, rate=rate)
    np.testing.assert_allclose(trace.force, force(x, rate), rtol=0, atol=1e-13)
    fine_x, fine_time, fine_rate = smooth_path(points, per_segment=20_000)
    power = force(fine_x, fine_rate) * fine_rate
    work = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(fine_time) * (power[1:] + power[:-1]))])[::50]
    # The trapezoidal rule at 20 000 points per half cosine: (pi / 20000)^2 / 12 times the curvature of the power.
    np.testing.assert_allclose(trace.work, work, rtol=0, atol=1e-7)


def test_rate_by_differences_is_of_second_order():
    law, errors = laws.KelvinVoigt(k=1.0, c=1.0), []
    for n in (100, 200):
        time = np.linspace(0.0, 2.0 * np.pi, n + 1)
        force = law.trace(np.sin(time), time=time).force
        errors.append(np.abs(force - np.sin(time) - np.cos(time)).max())
    # Halving the step takes a quarter; the next order is 6 % of it at 100 samples a cycle.
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_work_of_an_unloading_that_bends_near_its_pole_is_that_of_fine_steps():
    law = laws.BoucWen(alpha=3.0, beta=0.375, gamma=-0.328125, n=2.0, k=0.0)
    path = np.concatenate([np.linspace(0.0, 2.5, 5000), np.linspace(2.5, 0.0, 5000)[1:]])
    # 10.54 J: adaptive panels of the whole way against closed forms over 10 000 short ones.
    assert law.trace([0.0, 2.5, 0.0]).work[-1] == pytest.approx(law.trace(path).work[-1], rel=1e-10)


@pytest.mark.quick
def test_pinching_whose_width_begins_at_zero_is_integrated_in_finite_steps():
    """Without `lam` the first step was as long as the width: nothing. In one stroke and in many it comes to the same."""
    law = laws.LAWS["bouc-wen-baber-noori"](
        alpha=1e5, beta=250.0, gamma=100.0, n=1.0, k=4e4, delta_nu=0.1, zeta=0.6, q=0.1, p=1.0, psi=60.0, delta_psi=5.0
    )
    stroke = np.concatenate([np.linspace(0.0, -3e-4, 2), np.linspace(-3e-4, 5e-3, 4)[1:]])
    fine = np.concatenate([np.linspace(a, b, 60, endpoint=False) for a, b in itertools.pairwise(stroke)] + [stroke[-1:]])
    # Each of the few strokes is known to 1e-8, and the widths of the pinching to as much.
    assert law.trace(stroke).force[-1] == pytest.approx(law.trace(fine).force[-1], rel=1e-7)


@pytest.mark.parametrize("rounding", [1e-5, 1e-4, 2e-3])
@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_work_on_a_stop_is_that_of_its_potential_however_short_its_rounding_is(exponent, rounding):
    """Its force beyond a short rounding begins nearly as the power of a depth: 5e-9 of the work was lost there."""
    k, depth = 4e6, 0.01
    law = laws.Stop(gap_below=2e-3, k=k, exponent=exponent, rounding=rounding)
    within = quad(lambda t: k * rounding * (rounding * (t**3 - t**4 / 2.0)) ** exponent, 0.0, 1.0, epsabs=0.0, epsrel=1e-13)[0]
    ends = (depth - 0.5 * rounding) ** (exponent + 1.0) - (0.5 * rounding) ** (exponent + 1.0)
    work = within + k / (exponent + 1.0) * ends
    assert law.trace([0.0, -law.gap_below - depth]).work[-1] == pytest.approx(work, rel=1e-12)
