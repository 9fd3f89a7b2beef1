"""The smooth approximation of a law: how it tends to the law, what it keeps, and that MuJoCo draws it."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from examples_drawn import examples
from house import quiet, sdof
from hypothesis import given
from hypothesis import strategies as st
from laws_for_tests import MIRRORED, STRATEGIES, example, passive, smooth_path, turning_points
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

import wirerope_mj as wr
from wirerope_mj.dynamics.single_mass.balance import harmonic_balance
from wirerope_mj.mounts.laws import LAWS, BoucWen, Masing, Zener, registry, timed
from wirerope_mj.mounts.laws.wrapped import Smoothed

NAMES = [
    "asymmetric-bouc-wen", "bouc-wen", "enhanced-dry-friction", "ozdemir", "symmetric-bouc-wen", "vaiana-rosati",
]  # fmt: skip
every_law = pytest.mark.parametrize("name", NAMES)
few = examples(15)
widths = st.floats(0.01, 1.0)
TURN = 2.0 * np.pi


def bounded(law):
    """Return whether z stays finite far below the width, where its slope is alpha - gamma |z|^n whatever beta is."""
    return getattr(law, "gamma", 0.0) >= 0.0 or law.n <= 1.0


def smoothed(data, name):
    return Smoothed(law=data.draw(STRATEGIES[name].filter(bounded)), width=data.draw(widths))


def size(values):
    return max(float(np.abs(values).max()), 1e-3)


@every_law
def test_its_error_falls_with_the_square_of_the_width(name):
    law = example(name)
    time = np.arange(8 * 400 + 1) / 400
    x, rate, last = 0.008 * np.sin(TURN * time), 0.008 * TURN * np.cos(TURN * time), slice(-401, None)
    exact = law.trace(x)
    shares, errors = (0.04, 0.02, 0.01, 0.005), []
    for share in shares:
        loop = Smoothed(law=law, width=share * 0.008 * TURN).trace(x, time=time, rate=rate)
        errors.append(np.abs(loop.force[last] - exact.force[last]).max() / size(exact.force))
    # The blend lasts a path of (width / v)^2 A before a reversal and after it (measured: slopes 1.98 to 2.00).
    assert np.polyfit(np.log(shares), np.log(errors), 1)[0] == pytest.approx(2.0, abs=0.06)
    assert errors[-1] < 1e-3


def test_it_is_bouc_wens_equation_with_the_sign_of_the_velocity_rounded():
    law, width = BoucWen(alpha=1.0, beta=0.5, gamma=0.3, n=1.0), 0.05

    def rate(t, z):
        v = np.cos(t)
        return v - (0.3 * v + 0.5 * v * np.tanh(v / width) * np.sign(z)) * np.abs(z)

    reference = solve_ivp(rate, (0.0, 6.0), [0.0], rtol=1e-12, atol=1e-13, max_step=0.005, method="DOP853")
    time = np.linspace(0.0, 6.0, 1201)
    loop = Smoothed(law=law, width=width).trace(np.sin(time), time=time, rate=np.cos(time))
    # The path is a cubic between samples, 0.005^4 / 384 off; the reference meets a kink at z = 0 in a step of 0.005.
    assert loop.hysteretic_state[-1] == pytest.approx(reference.y[0, -1], abs=1e-10)


def test_far_below_the_width_z_goes_on_to_the_bound_of_the_blend():
    """With v so that tanh is a quarter, dz/dx = 1 - |z| / 4: the bound is four times that of either slope."""
    v = np.arctanh(0.25)
    time = np.linspace(0.0, 20.0 / v, 101)
    loop = Smoothed(law=BoucWen(alpha=1.0, beta=1.0, gamma=0.0, n=1.0), width=1.0).trace(
        v * time, time=time, rate=v + 0.0 * time
    )
    np.testing.assert_allclose(loop.hysteretic_state, 4.0 * (1.0 - np.exp(-v * time / 4.0)), rtol=0, atol=1e-8)


@every_law
@given(data=st.data(), points=turning_points, slower=st.floats(0.01, 100.0))
@few
def test_slower_by_a_factor_it_needs_a_narrower_width(name, data, points, slower):
    law = smoothed(data, name)
    x, time, rate = smooth_path(points, per_segment=8)
    loop = law.trace(x, time=time, rate=rate)
    same = replace(law, width=law.width / slower).trace(x, time=slower * time, rate=rate / slower)
    # A trace is promised to 1e-8, and these are two: a law that hardly dissipates forgets no step's error.
    np.testing.assert_allclose(same.force, loop.force, rtol=0, atol=2e-8 * size(loop.force))
    with pytest.raises(ValueError, match="`time` must be given"):
        law.trace(x)


@every_law
@given(data=st.data(), points=turning_points)
@few
def test_mirrored_path_gives_the_mirrored_force(name, data, points):
    law = smoothed(data, name)
    other = replace(law, law=MIRRORED[name](law.law)) if name in MIRRORED else law
    x, time, rate = smooth_path(points, per_segment=8)
    loop, mirrored = law.trace(x, time=time, rate=rate), other.trace(-x, time=time, rate=-rate)
    np.testing.assert_allclose(mirrored.force, -loop.force, rtol=0, atol=1e-8 * size(loop.force))


@pytest.mark.slow
@every_law
@given(data=st.data(), points=turning_points)
@examples(40)
def test_no_path_from_the_unloaded_state_gains_work(name, data, points):
    law = data.draw(STRATEGIES[name].filter(lambda law: passive(law) and bounded(law)))
    x, time, rate = smooth_path(points, per_segment=12)
    work = Smoothed(law=law, width=data.draw(widths)).trace(x, time=time, rate=rate).work
    assert work.min() >= -1e-7 * max(1.0, np.abs(work).max())  # n < 1 has an infinite curvature at z = 0


@every_law
@given(data=st.data(), points=turning_points)
@few
def test_a_path_step_by_step_is_the_path_at_once(name, data, points):
    law = smoothed(data, name)
    x, time, rate = smooth_path(points, per_segment=5)
    loop, states, work = law.trace(x, time=time, rate=rate), np.zeros(1), 0.0
    for i in range(x.size - 1):
        two = slice(i, i + 2)
        step = law.trace(x[two], time=time[two], rate=rate[two], initial_states=states)
        states, work = step.internal_states[-1], work + step.work[-1]
        assert step.force[-1] == pytest.approx(loop.force[i + 1], rel=1e-12, abs=1e-12)  # instants differ by rounding
    assert work == pytest.approx(loop.work[-1], rel=1e-10, abs=1e-10)


def test_its_work_along_a_path_does_not_depend_on_how_finely_the_path_is_cut():
    """The power has kinks at the knots of a table, where the state has none: steps by the state alone are off by 8e-6."""
    law = Smoothed(
        law=LAWS["tabulated"](
            deflection=[-3.0, -2.0, -1.0, 0.0, 3.0], force=[-1.0, -1.0, 0.0, 0.0, 0.0], curve="mid", extrapolate=True,
            amplitudes=[0.5, 2.0], areas=[1.6, 7.6], yield_deflection=0.1,
        ),
        width=0.1,
    )  # fmt: skip
    x, time, rate = smooth_path([0.0, 2.0, -3.0], per_segment=6)
    path, fine = CubicHermiteSpline(time, x, rate), np.linspace(time[0], time[-1], 128 * (time.size - 1) + 1)
    coarse, cut = law.trace(x, time=time, rate=rate), law.trace(path(fine), time=fine, rate=path(fine, 1))
    # What a trace promises.
    np.testing.assert_allclose(coarse.work, cut.work[::128], rtol=0, atol=1e-8 * np.abs(cut.work).max())


# Paths on which little but rounding is left of the power.
HARDLY_ANY_POWER = {
    "a picometre and back": (
        BoucWen(alpha=0.176806, beta=0.884031, gamma=0.0, n=1.0, k=0.0605), [0.0, 2.8e-11, 0.0, -2.0, 0.0],
    ),
    "a picometre of a law that begins aside": (
        LAWS["vaiana-rosati"](kb=0.7, f0=1.2, alpha=3.1, b1=0.5, b2=0.16, g1=0.94, g2=0.13, g3=0.71), [0.0, 1e-12],
    ),
}  # fmt: skip


@pytest.mark.parametrize("path", HARDLY_ANY_POWER)
def test_where_hardly_any_power_is_left_its_integration_ends(path, monkeypatch):
    if not hasattr(timed.follow_time, "py_func"):
        pytest.skip("the compiler is off")
    (law, points), slope_at, calls = HARDLY_ANY_POWER[path], timed.slope_at, itertools.count(1)

    def counted(*arguments):
        assert next(calls) < 100_000
        return slope_at(*arguments)

    for name in ("follow_time", "work_of_law", "work_over", "integrate_in_time"):
        monkeypatch.setattr(timed, name, getattr(timed, name).py_func)
    monkeypatch.setattr(timed, "slope_at", counted)
    x, time, rate = smooth_path(points, per_segment=8 if len(points) > 2 else 1)
    Smoothed(law=law, width=0.364).trace(x, time=time, rate=rate)


def test_compiled_and_plain_kernels_agree():
    law = Smoothed(law=example("asymmetric-bouc-wen"), width=0.02)
    if not hasattr(registry.smoothed, "py_func"):
        pytest.skip("the compiler is off")
    p, z, fast, plain = law.kernel_parameters(), np.array([120.0]), np.zeros(1), np.zeros(1)
    for v in (-0.3, -0.01, 0.0, 0.02, 1.0):
        force = registry.evaluate(registry.SMOOTHED, p, 0, 0.004, v, z, 0, fast, 0)
        assert registry.smoothed.py_func(p, 0, 0.004, v, z, 0, plain, 0) == pytest.approx(force, rel=1e-14)
        assert plain == pytest.approx(fast, rel=1e-14)
        assert v != 0.0 or fast[0] == 0.0  # no creep


@every_law
def test_mujoco_draws_the_loop_of_its_trace_with_both_callbacks(name):
    law = Smoothed(law=example(name), width=0.02)
    shaking = wr.Sine(frequency=10.0, acceleration=3.0 * wr.STANDARD_GRAVITY, direction="z")
    options = {"duration": 0.2, "timestep": 1e-4, "sample_rate": 10_000.0, "initial": "unloaded"}
    native, python = (
        wr.simulate(sdof(law, mass=20.0), shaking, callback=callback, engine="mujoco", **options)
        for callback in ("native", "python")
    )
    m = native.mounts["m1"]
    np.testing.assert_array_equal(python.mounts["m1"].force, m.force)
    np.testing.assert_array_equal(python.mounts["m1"].hysteretic_state, m.hysteretic_state)
    rate = native.bodies["mass"].velocity[:, 2] - native.base.velocity[:, 2]
    trace = law.trace(m.deflection[:, 2], time=native.time, rate=rate)
    # As for the laws themselves: Runge-Kutta steps over kinks at z = 0, 1e-4 of the force.
    assert np.abs(m.force[:, 2] - trace.force).max() < 1e-4 * np.abs(trace.force).max()
    assert np.abs(m.hysteretic_state[:, 2] - trace.hysteretic_state).max() < 1e-4 * np.abs(trace.force).max()


def test_at_rest_nothing_creeps():
    law = Smoothed(law=example("bouc-wen"), width=0.05)
    system = sdof(law, mass=20.0, gravity=wr.STANDARD_GRAVITY)
    rest = wr.equilibrium(system)
    r = wr.simulate(system, quiet(), duration=1.0, timestep=1e-3)
    m = r.mounts["m1"]
    assert m.deflection[-1, 2] == pytest.approx(-20.0 * wr.STANDARD_GRAVITY / law.law.k, rel=1e-6)  # z = 0
    assert m.deflection[0, 2] == pytest.approx(rest.mounts["m1"].deflection[2], rel=1e-12)
    # What the equilibrium leaves unbalanced, 1e-10 of the weight, swings about it.
    assert np.ptp(m.deflection[:, 2]) < 1e-9 * abs(m.deflection[0, 2])
    assert np.ptp(m.hysteretic_state[:, 2]) < 1e-9 * 20.0 * wr.STANDARD_GRAVITY


@pytest.mark.slow
def test_its_periodic_motions_tend_to_those_of_the_law():
    law = BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0)
    setting = {"mass": 1.0, "frequency": 0.8 / TURN, "acceleration": 0.3, "harmonics": 7, "samples": 256}
    exact = harmonic_balance(law, **setting)
    errors = []
    for share in (0.1, 0.05):
        width = share * 0.8 * exact.largest_deflection
        orbit = harmonic_balance(Smoothed(law=law, width=width), guess=exact.coefficients, tolerance=1e-8, **setting)
        errors.append(abs(orbit.amplitude / exact.amplitude - 1.0))
    assert errors[1] < 2e-3  # measured: 1.2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_what_cannot_be_smoothed_is_said():
    law = BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0)
    assert "smoothed" not in LAWS  # an isolator file holds the law itself
    with pytest.raises(ValueError, match="a slope times the velocity, got masing"):
        Smoothed(law=Masing(stiffness=[1.0], slip_force=[1.0]), width=0.1)
    with pytest.raises(ValueError, match="a slope times the velocity, got zener"):
        Smoothed(law=Zener(k0=1.0, k1=1.0, c=1.0), width=0.1)
    with pytest.raises(ValueError, match="a slope times the velocity, got 3"):
        Smoothed(law=3, width=0.1)
    with pytest.raises(ValueError, match="`width` must be > 0"):
        Smoothed(law=law, width=0.0)
    with pytest.raises(ValueError, match="`width` must be a finite number"):
        Smoothed(law=law, width=np.nan)
    with pytest.raises(ValueError, match="is not written to a file"):
        Smoothed(law=law, width=0.1).to_dict()
