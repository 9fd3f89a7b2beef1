"""Bouc-Wen laws with n < 1, whose tangent has a cusp at z = 0: states, closed cycles and modes against other ways to them."""

import itertools

import numpy as np
import pytest
from house import sdof
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import roots_legendre

import wirerope_mj as wr
from wirerope_mj.cli.app import main
from wirerope_mj.content.modes import about_carried, about_small
from wirerope_mj.dynamics.modes import modes
from wirerope_mj.dynamics.modes.carried import carried
from wirerope_mj.dynamics.modes.mount import closed_cycle
from wirerope_mj.dynamics.single_mass.equivalent import oscillator_at
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.mounts.isolator import Provenance
from wirerope_mj.mounts.laws import power
from wirerope_mj.mounts.laws.bouc_wen import LEAST_EXPONENT
from wirerope_mj.mounts.laws.steady import follow_force, next_start

EXPONENTS = [0.1, 0.13, 0.22, 0.5, 1.0, 2.0, 5.0]
AMPLITUDES = [1e-5, 1e-4, 1e-3, 5e-3, 15e-3]


def softening(n, **changes):
    """Return a law of the size of a mount for 3.5 kg with beta > gamma."""
    return wr.BoucWen.from_normalised(**{"z_max": 60.0, "x_y": 6e-4, "sigma": 0.7, "n": n, "k": 1e5} | changes)


def asymmetric(n):
    """Return Ni's law of that size."""
    form = {"z_max": 60.0, "x_y": 6e-4, "sigma": 0.7, "n": n}
    return wr.AsymmetricBoucWen.from_normalised(**form, k1=1e5, k2=0.0, k3=1e7, b=np.e, c=5.0)


def length_from_zero(alpha, b, n, u):
    """Return int_0^u dz / (alpha - b z^n) by Gauss and Legendre's rule over ln z, finer towards the end."""
    nodes, weights = roots_legendre(40)
    ends = np.log(u) - np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 20), np.arange(2.0, 45.0)])
    middle, half = 0.5 * (ends[:-1] + ends[1:]), 0.5 * (ends[:-1] - ends[1:])
    z = np.exp(middle[:, None] + half[:, None] * nodes)
    return float(np.sum(half[:, None] * weights * z / (alpha - b * z**n)))


@pytest.mark.parametrize("n", [LEAST_EXPONENT, 0.1, 0.13, 0.22, 0.5, 0.99])
@pytest.mark.parametrize("sigma", [0.3, 0.7, 1.6])
def test_states_grow_and_shrink_over_the_length_that_their_slope_gives(n, sigma):
    law = softening(n, sigma=sigma, k=0.0)
    parameters = law.kernel_parameters()
    path = np.concatenate([[0.0], np.geomspace(1e-12, 2e-3, 40)])
    for path_z, z in zip(path[1:], follow_force(law.kernel, parameters, path, np.zeros(1), 1)[1:], strict=True):
        if z < 0.99 * law.z_max:  # beyond, a length says little about a state
            assert length_from_zero(law.alpha, law.beta + law.gamma, n, z) == pytest.approx(path_z, rel=1e-13)
    back = law.gamma - law.beta
    whole = length_from_zero(law.alpha, back, n, 40.0)
    left = whole * np.geomspace(1.0, 1e-6, 20)
    shrinking = -follow_force(law.kernel, parameters, whole - left, np.array([-40.0]), 1)
    for length, z in zip(left, shrinking, strict=True):
        assert length_from_zero(law.alpha, back, n, z) == pytest.approx(length, rel=0.0, abs=1e-13 * whole)


def harmonic_by_integration(law, deflection, amplitude):
    """Return stiffness + i * loss of the closed cycle: z integrated over half cosines by SciPy, closed by a search.

    Legs end where z is zero, so that none holds the kink there.
    """

    def leg(z, begin, end, direction):
        def slope(x, z):
            inside = law.beta * np.sign(direction * z[0]) + law.gamma
            return [law.alpha - inside * abs(z[0]) ** law.n]

        def crossing(x, z):
            return z[0]

        crossing.terminal = True
        parts = []
        while True:
            way = (begin, end)
            found = solve_ivp(slope, way, [z], "DOP853", rtol=1e-10, atol=1e-12, events=crossing, dense_output=True)
            parts.append((begin, found.t[-1], found.sol))
            z, begin = float(found.y[0, -1]), float(found.t[-1])
            if found.status == 0:
                return z, parts
            z = direction * 1e-12  # on the other side of zero

    low, high = deflection - amplitude, deflection + amplitude

    def gain(z):
        down, _ = leg(z, high, low, -1.0)
        up, _ = leg(down, low, high, 1.0)
        return up - z

    top = brentq(gain, -1.1 * law.z_max, 1.1 * law.z_max, xtol=1e-10, rtol=1e-12)  # from beyond its bound z comes back
    down, falling = leg(top, high, low, -1.0)
    _, rising = leg(down, low, high, 1.0)
    angle = np.pi * (np.arange(2000) + 0.5) / 2000
    total = 0.0
    for parts, sign in ((falling, 1.0), (rising, -1.0)):
        x = deflection + sign * amplitude * np.cos(angle)
        z = np.empty_like(x)
        for begin, end, solution in parts:
            inside = (x - begin) * (x - end) <= 0.0
            z[inside] = solution(x[inside])[0]
        phase = angle if sign > 0.0 else angle + np.pi
        total = total + np.sum((law.k * x + z) * np.exp(-1j * phase))
    return 2.0 * total / (4000 * amplitude)


@pytest.mark.slow
@pytest.mark.parametrize("n", [0.1, 0.22, 0.5, 2.0])
@pytest.mark.parametrize("amplitude", [1e-5, 1e-3, 15e-3])
@pytest.mark.parametrize("sigma", [0.3, 0.7])
def test_closed_cycles_are_those_of_an_integration(n, amplitude, sigma):
    law = softening(n, sigma=sigma)
    found = closed_cycle(law, -1e-4, amplitude, frequency=1.0)
    expected = harmonic_by_integration(law, -1e-4, amplitude)
    # 256 samples of a loop with two sharp tips, against 4000.
    assert found == pytest.approx(expected, rel=2e-4)


def balanced(law, mass, found):
    """Return amplitude [m] and frequency [Hz] by the balance of one harmonic, shaken 10 % above the frequency of a mode.

    The base shakes as hard as the mode's stiffness and loss say for its amplitude; above, a spring that softens has one motion
    only. Newton's method starts at that motion and makes forces and inertia equal; the frequency is that of the stiffness which
    it ends with.
    """
    omega = 2.0 * np.pi * found.frequencies[0]
    spring = mass * (omega**2 - (1.1 * omega) ** 2) + 2j * mass * found.damping_ratio[0] * omega**2
    acceleration = abs(spring) * found.amplitude / mass
    orbit = wr.harmonic_balance(
        law, mass=mass, frequency=1.1 * found.frequencies[0], acceleration=acceleration, gravity=wr.STANDARD_GRAVITY,
        harmonics=1, guess=[found.equilibrium.mounts["m1"].deflection[2], 1j * mass * acceleration / spring],
        tolerance=1e-6,  # with n = 5 the memory of 0.01 mm fades over 1e9 cycles, and closes to 1e-8 of the force
    )  # fmt: skip
    force, deflection = (2.0 * np.fft.rfft(one[:-1])[1] / (one.size - 1) for one in (orbit.force, orbit.deflection))
    return abs(deflection), float(np.sqrt((force / deflection).real / mass) / (2.0 * np.pi))


def compare(law, amplitude):
    """Hold the mode of 3.5 kg on a law at an amplitude against harmonic balance, and print the row of the comparison."""
    system = sdof(law, mass=3.5, gravity=wr.STANDARD_GRAVITY)
    found = modes(system, amplitude=amplitude)
    size, expected = balanced(law, 3.5, found)
    row = law.n, 1e3 * amplitude, found.frequencies[0], expected, found.frequencies[0] / expected - 1.0
    print("n = {:<5g} {:>6g} mm  modes {:9.5f} Hz  balance {:9.5f} Hz  apart {:+.1e}".format(*row))
    assert found.frequencies[0] == pytest.approx(expected, rel=1e-2)
    assert size == pytest.approx(amplitude, rel=0.1)  # 1 % of frequency is 10 % of it there
    assert found.stability.stable


@pytest.mark.parametrize("n", [0.13, 0.22])
@pytest.mark.parametrize("amplitude", [1e-5, 15e-3])
def test_modes_at_an_amplitude_are_those_of_harmonic_balance(n, amplitude):
    compare(asymmetric(n), amplitude)


@pytest.mark.parametrize("amplitude", [5e-3, 15e-3])
def test_a_large_cycle_of_a_lopsided_law_is_said_where_it_carries_the_weight(amplitude):
    """About rest its frequency is off by 1 and 13 %; the command names that about where the mean force is the weight."""
    law = wr.load_isolator(models_folder() / "isolators" / "sdof_36hz.toml").axial
    system = sdof(law, mass=3.5, gravity=wr.STANDARD_GRAVITY)
    found = modes(system, history="virgin", amplitude=amplitude)
    there = carried(system, found)
    weight = 3.5 * wr.STANDARD_GRAVITY
    linear = oscillator_at(law, amplitude, frequency=1.0, weight=weight)
    omega = np.sqrt(linear.stiffness / 3.5)
    loss = linear.energy / (np.pi * amplitude**2)
    orbit = wr.harmonic_balance(
        law, mass=3.5, frequency=omega / (2 * np.pi), acceleration=loss * amplitude / 3.5, gravity=wr.STANDARD_GRAVITY,
        harmonics=1, guess=[linear.offset, amplitude],
    )  # fmt: skip
    assert abs(orbit.coefficients[1]) == pytest.approx(amplitude, rel=1e-3)
    assert there.frequencies[0] == pytest.approx(orbit.frequency, rel=1e-3)
    assert abs(found.frequencies[0] / orbit.frequency - 1.0) > 0.01
    words = list(about_carried(system, modes(system), [found]))
    assert len(words) == 1
    assert f"mode 1 at {there.frequencies[0]:.3f} instead of {found.frequencies[0]:.3f} Hz (m1 " in words[0]


def test_the_next_start_stays_within_what_cycles_have_bracketed():
    """A secant that a kink has made flat points to 1e16 N; a bend that it cannot follow is halved instead."""
    bracket = np.array([-np.inf, np.inf])
    first = next_start(np.array([1.0, 2.0]), np.array([1.0, 1.0 - 1e-15]), bracket)
    assert 2.0 < first <= 10.0
    assert bracket.tolist() == [2.0, np.inf]
    assert next_start(np.array([2.0, 10.0]), np.array([1.0, -0.9]), bracket) == 6.0


def test_an_exponent_too_small_is_refused_with_the_bound_and_the_file(tmp_path):
    """Of 0.001 the table of the command once took more than 40 minutes."""
    file = tmp_path / "jump.toml"
    wr.Isolator(name="jump", axial=softening(0.1), provenance=Provenance(kind="illustrative", source="made up")).save(file)
    file.write_text(file.read_text().replace("n = 0.1\n", "n = 0.001\n"))
    with pytest.raises(ValueError, match=r"`n` must be >= 0.05, got 0.001: .*dry friction"):
        softening(0.001)
    with pytest.raises(wr.ModelError, match=r"jump.toml, line \d+: \[axial\] `n` must be >= 0.05, got 0.001"):
        wr.load_isolator(file)


def test_the_least_exponent_takes_few_series_along_a_stroke(capsys, tmp_path, monkeypatch):
    file = tmp_path / "least.toml"
    made_up = Provenance(kind="illustrative", source="made up")
    wr.Isolator(name="least", axial=softening(LEAST_EXPONENT), provenance=made_up).save(file)
    assert main(["isolators", str(file)]) == 0
    assert "n = 0.05" in capsys.readouterr().out
    if not hasattr(power.series, "py_func"):
        return
    count, expand, z = itertools.count(), power.series, np.array([-59.0])
    monkeypatch.setattr(power, "series", lambda *arguments: next(count) < 0 or expand(*arguments))
    monkeypatch.setattr(power, "state_after", power.state_after.py_func)
    parameters = softening(LEAST_EXPONENT).kernel_parameters()
    power.carry_power.py_func(parameters, 0, -0.015, 0.015, z, 0, *np.empty((2, power.ORDER + 1)))
    assert 0.0 < z[0] < np.inf
    assert next(count) < 12 / LEAST_EXPONENT  # measured: 186, and 1,053 with a tenth of that exponent


@pytest.mark.parametrize("sigma", [0.7, 0.3])
def test_the_command_says_where_small_cycles_lie(sigma):
    system = sdof(softening(0.5, sigma=sigma), gravity=wr.STANDARD_GRAVITY)
    small = modes(system)
    between = small.loading[0] < small.frequencies[0] < small.unloading[0]
    assert between == (sigma > 0.5)
    *outside, exponent = about_small(system, small)
    assert [text.startswith("In mode 1 the small-amplitude natural frequency is not between") for text in outside] == (
        [] if between else [True]
    )
    assert "n < 1" in exponent


@pytest.mark.slow
@pytest.mark.parametrize("n", EXPONENTS)
@pytest.mark.parametrize("amplitude", AMPLITUDES)
@pytest.mark.parametrize("make", [softening, lambda n: softening(n, sigma=0.3), asymmetric])
def test_modes_are_those_of_harmonic_balance_for_every_exponent_and_amplitude(make, n, amplitude):
    compare(make(n), amplitude)
