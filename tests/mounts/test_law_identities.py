"""What one law says of another, and closed forms of loops: areas, skeletons, complex stiffnesses."""

import math

import mujoco
import numpy as np
import pytest
from laws_for_tests import path_through
from scipy.integrate import solve_ivp
from scipy.special import gamma as gamma_function

from wirerope_mj.mounts import laws
from wirerope_mj.mounts.test_rig import cyclic_test

pytestmark = pytest.mark.quick

RNG = np.random.default_rng(7)
PATHS = [path_through(RNG.uniform(-2.0, 2.0, 15), per_segment=4) for _ in range(4)]


def steady(law, amplitude, *, omega=1.0, cycles=1, per_cycle=400):
    """Return the trace of A sin(w t), with its exact rate, and the slice of its last cycle."""
    time = np.arange(cycles * per_cycle + 1) * 2.0 * np.pi / (omega * per_cycle)
    x, rate = amplitude * np.sin(omega * time), amplitude * omega * np.cos(omega * time)
    return law.trace(x, time=time, rate=rate), slice(-per_cycle - 1, None)


def last_energy(law, amplitude, **settings):
    """Return the work of the last cycle of `steady`."""
    trace, last = steady(law, amplitude, **settings)
    return trace.work[last][-1] - trace.work[last][0]


# Bouc-Wen and its relatives


def test_tno_bouc_wen_dahl_and_vaiana_rosati_are_one_law():
    k, d, u_c = 0.4, 1.3, 0.5
    tno = laws.EnhancedDryFriction(k=k, d=d, u_c=u_c)
    bouc_wen = laws.BoucWen(alpha=d / u_c, beta=1.0 / u_c, gamma=0.0, n=1, k=k)
    vaiana = laws.VaianaRosati(kb=k, f0=d, alpha=1.0 / u_c)
    for path in PATHS:
        force = tno.trace(path).force
        np.testing.assert_array_equal(force, bouc_wen.trace(path).force)
        np.testing.assert_allclose(vaiana.trace(path).force, force, rtol=0, atol=1e-13)  # rounding of the exponentials
        np.testing.assert_allclose(vaiana.trace(path).work, tno.trace(path).work, rtol=0, atol=1e-12)
        # Dahl's own equation with exponent 1, dF/dx = sigma |1 - (F/Fc) s| sgn(1 - (F/Fc) s), sigma = d / u_c.
        friction = [0.0]
        for a, b in zip(path, path[1:], strict=False):
            s = np.sign(b - a)

            def slope(_l, f, s=s):
                share = 1.0 - s * f / d
                return s * d / u_c * np.abs(share) * np.sign(share)

            run = solve_ivp(slope, (0.0, abs(b - a)), [friction[-1]], method="DOP853", rtol=1e-12, atol=1e-14)
            friction.append(run.y[0, -1])
        # 60 integrations at 1e-12.
        np.testing.assert_allclose(force, k * path + friction, rtol=0, atol=1e-11)


@pytest.mark.parametrize("amplitude", [0.05, 0.5, 3.0])
def test_area_of_the_dry_friction_loop(amplitude):
    d, u_c = 1.3, 0.5
    loop = cyclic_test(laws.EnhancedDryFriction(k=0.7, d=d, u_c=u_c), amplitude)[0]
    expected = 4.0 * d * (amplitude - u_c * math.tanh(amplitude / u_c))
    # At the smallest amplitude the bracket loses 1/300 of its terms, and the closure, 1e-10, counts as much.
    assert loop.dissipated_energy == pytest.approx(expected, rel=1e-7)
    assert loop.hysteretic_state.max() == pytest.approx(d * math.tanh(amplitude / u_c), rel=1e-8)


def test_ozdemir_with_a_back_force_is_the_rate_equation_of_its_author():
    k, yields, slope, n = 2.0, 0.8, 0.15, 3
    law = laws.Ozdemir(alpha=(1.0 - slope) * k, beta=k / yields**n, n=n, k=slope * k)
    path, force = PATHS[0], [0.0]
    for a, b in zip(path, path[1:], strict=False):
        s = np.sign(b - a)

        # F' = k [x' - |x'| ((F - B) / F0)^n] with the back force B = slope k x; n is odd.
        def rate(length, f, s=s, a=a):
            return s * k * (1.0 - s * ((f - slope * k * (a + s * length)) / yields) ** n)

        run = solve_ivp(rate, (0.0, abs(b - a)), [force[-1]], method="DOP853", rtol=1e-12, atol=1e-14)
        force.append(run.y[0, -1])
    # |z|^3 has a kink in its third derivative at z = 0, which the reference does not split.
    np.testing.assert_allclose(law.trace(path).force, force, rtol=0, atol=1e-9)


def song_and_der_kiureghian(path, *, alpha, beta, gamma, n):
    """Return z along `path` by psi = b1 sgn(v z) + b2 sgn(x v) + b3 sgn(x z), and the phases (x, v, z) that were met."""
    b1, b2, b3 = beta + gamma, -gamma, gamma
    z, out, phases = 0.0, [0.0], set()
    for start, end in zip(path, path[1:], strict=False):
        s, at, length = np.sign(end - start), 0.0, abs(end - start)
        while at < length:
            x_sign = np.sign(start + s * at) if abs(start + s * at) > 1e-9 else s
            z_sign = np.sign(z) if abs(z) > 1e-9 else s
            phases.add((x_sign, s, z_sign))
            psi = b1 * s * z_sign + b2 * x_sign * s + b3 * x_sign * z_sign

            def rate(_l, y, s=s, psi=psi):
                return s * (alpha - np.abs(y) ** n * psi)

            def crossing(_l, y):
                return y[0]

            crossing.terminal, crossing.direction = True, -z_sign
            stop = min(length, abs(start)) if x_sign != s and at < abs(start) - 1e-9 else length
            run = solve_ivp(rate, (at, stop), [z], method="DOP853", rtol=1e-12, atol=1e-14, events=crossing)
            at, z = run.t[-1], run.y[0, -1]
            if run.t_events[0].size:
                z = 0.0
        out.append(z)
    return np.array(out), phases


SIX_PHASES = {(1, 1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1), (-1, 1, -1), (-1, 1, 1)}


def test_song_and_der_kiureghians_psi_is_bouc_wen_in_their_six_phases_and_not_beyond():
    parameters = {"alpha": 2.0, "beta": 0.7, "gamma": 0.4, "n": 1.5}
    law = laws.BoucWen(**parameters)
    # Each half cycle crosses z = 0 before x = 0 and both before it turns.
    cycles = [0.0, 1.0, -0.8, 1.2, -1.3, 0.7, -0.9]
    z, phases = song_and_der_kiureghian(cycles, **parameters)
    assert phases == SIX_PHASES
    np.testing.assert_allclose(law.trace(cycles).hysteretic_state, z, rtol=0, atol=1e-9)
    # Reloading at x > 0 while z < 0 is the seventh phase: there psi has another slope.
    partial = [0.0, 1.0, 0.1, 0.4]
    z, phases = song_and_der_kiureghian(partial, **parameters)
    assert (1, 1, -1) in phases
    assert abs(law.trace(partial).hysteretic_state[-1] - z[-1]) > 1e-2


def test_normalised_form_is_a_constructor_and_a_report():
    law = laws.BoucWen.from_normalised(z_max=300.0, x_y=2e-3, sigma=0.8, n=1.5, k=1e4)
    assert law.alpha == pytest.approx(1.5e5)
    assert law.beta == pytest.approx(0.8 * 1.5e5 / 300.0**1.5)
    assert law.gamma == pytest.approx(0.2 * 1.5e5 / 300.0**1.5)
    form = law.normalised
    assert (form.z_max, form.x_y, form.sigma, form.n) == pytest.approx((300.0, 2e-3, 0.8, 1.5))
    # Its shape knows no unit: in kN and mm the same loop, where alpha, beta and gamma alone would not show it.
    other = laws.BoucWen.from_normalised(z_max=0.3, x_y=2.0, sigma=0.8, n=1.5, k=1e-2)
    np.testing.assert_allclose(1e3 * other.trace(3.0 * PATHS[0]).force, law.trace(3e-3 * PATHS[0]).force, rtol=0, atol=1e-6)
    with pytest.raises(ValueError, match="`beta` \\+ `gamma` must be > 0"):
        _ = laws.BoucWen(alpha=1.0, beta=0.8, gamma=-1.0, n=1).normalised
    with pytest.raises(ValueError, match="`x_y` must be > 0"):
        laws.BoucWen.from_normalised(z_max=1.0, x_y=0.0, sigma=0.5, n=1)


def test_a_sharp_bouc_wen_law_tends_to_one_jenkin_element():
    c, h = 2.0, 0.8
    jenkin = laws.Masing(stiffness=[c], slip_force=[h])
    errors = []
    for n in (5.0, 20.0, 80.0):
        law = laws.BoucWen.from_normalised(z_max=h, x_y=h / c, sigma=0.5, n=n)
        errors.append(max(np.abs(law.trace(path).force - jenkin.trace(path).force).max() for path in PATHS) / h)
    print("largest error over h for n = 5, 20, 80:", errors)
    # The corner is rounded over a share of about 1/n; inner loops of Bouc-Wen drift by as much.
    assert errors[0] > 2.5 * errors[1] > 6.0 * errors[2]
    assert errors[2] < 0.02


# Masing

ELEMENTS = {"stiffness": [2.0, 1.0, 0.5], "slip_force": [0.4, 0.7, 0.9], "k": 0.3}


def virgin(x):
    """Return the Masing law's virgin force at |x|, an odd function."""
    size = np.abs(x)
    pairs = zip(ELEMENTS["stiffness"], ELEMENTS["slip_force"], strict=True)
    return np.sign(x) * (ELEMENTS["k"] * size + sum(np.minimum(c * size, h) for c, h in pairs))


def test_masing_virgin_curve_and_masings_rule():
    law = laws.Masing(**ELEMENTS)
    up, down = np.linspace(0.0, 2.5, 26), np.linspace(2.5, -2.5, 41)
    np.testing.assert_allclose(law.trace(up).force, virgin(up), rtol=0, atol=1e-14)
    branch = law.trace(np.concatenate([up, down[1:]])).force[up.size :]
    # Every branch after a reversal is the virgin curve doubled, from the point of reversal.
    np.testing.assert_allclose(branch, virgin(2.5) + 2.0 * virgin((down[1:] - 2.5) / 2.0), rtol=0, atol=1e-13)


@pytest.mark.parametrize("amplitude", [0.1, 0.5, 1.0, 4.0])
def test_area_of_a_masing_loop(amplitude):
    pairs = zip(ELEMENTS["stiffness"], ELEMENTS["slip_force"], strict=True)
    expected = sum(4.0 * h * (amplitude - h / c) for c, h in pairs if amplitude > h / c)
    loop = cyclic_test(laws.Masing(**ELEMENTS), amplitude)[0]
    assert loop.dissipated_energy == pytest.approx(expected, rel=1e-12, abs=1e-14)


def test_masing_forgets_a_closed_inner_loop_and_bouc_wen_does_not():
    masing, bouc_wen = laws.Masing(**ELEMENTS), laws.BoucWen(alpha=3.5, beta=1.2, gamma=0.5, n=1, k=0.3)
    plain, interrupted = [0.0, 2.0, -1.0, 0.5], [0.0, 2.0, -1.0, -0.2, -0.7, -0.4, -1.0, 0.5]
    drift = {}
    for law in (masing, bouc_wen):
        with_loops = law.trace(interrupted)
        drift[law.name] = abs(with_loops.force[-1] - law.trace(plain).force[-1])
        drift[f"{law.name} at the inner loop's end"] = abs(with_loops.force[6] - with_loops.force[2])
    assert drift["masing"] < 1e-14
    assert drift["masing at the inner loop's end"] < 1e-14
    assert drift["bouc-wen at the inner loop's end"] > 0.05
    # An inner loop within an inner loop is forgotten too: after 0.7 nothing is left of 0.2 and 0.5.
    path = [0.0, 1.5, 0.2, 0.5, 0.2, 0.9]
    assert masing.trace(path).force[-1] == pytest.approx(masing.trace([0.0, 1.5, 0.2, 0.9]).force[-1], abs=1e-14)


@pytest.mark.parametrize("amplitude", [0.5, 1.5])
def test_first_harmonics_of_a_jenkin_element(amplitude):
    c, h, n = 2.0, 0.7, 8000
    phase = 2.0 * np.pi * np.arange(2 * n + 1) / n
    force = laws.Masing(stiffness=[c], slip_force=[h]).trace(np.concatenate([[0.0], amplitude * np.cos(phase)])).force
    last, angle = force[-n:], phase[-n:]
    theta = math.acos(1.0 - 2.0 * h / (c * amplitude))
    a1 = c * amplitude / math.pi * (theta - 0.5 * math.sin(2.0 * theta))
    b1 = -c * amplitude / math.pi * math.sin(theta) ** 2
    # Sums over n samples with four corners between them: (2 pi / n)^2.
    assert 2.0 * (last * np.cos(angle)).mean() == pytest.approx(a1, rel=1e-6)
    assert 2.0 * (last * np.sin(angle)).mean() == pytest.approx(b1, rel=1e-6)


def test_masing_is_mujocos_own_elastoplastic_tendons():
    """MuJoCo returns each tendon's spring reference to its yield surface after a step; the joint is held where it is put."""
    tendons = "".join(
        f'<fixed stiffness="{c}" springyield="{h / c!r}" springlength="0"><joint joint="j" coef="1"/></fixed>'
        for c, h in zip(ELEMENTS["stiffness"], ELEMENTS["slip_force"], strict=True)
    )
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="1e-6" gravity="0 0 0"/><worldbody><body><joint name="j" type="slide" armature="1e9" '
        f'stiffness="{ELEMENTS["k"]}"/><geom size=".1"/></body></worldbody><tendon>{tendons}</tendon></mujoco>'
    )
    data, law = mujoco.MjData(model), laws.Masing(**ELEMENTS)
    for path in PATHS:
        mujoco.mj_resetData(model, data)
        force = []
        for x in path:
            data.qpos[0], data.qvel[0] = x, 0.0
            mujoco.mj_step(model, data)
            data.qpos[0] = x
            mujoco.mj_forward(model, data)
            force.append(-data.qfrc_spring[0])
        # The held joint moves by 1e-21 in a step: the rest is rounding.
        np.testing.assert_allclose(law.trace(path).force, force, rtol=0, atol=1e-13)


# Laws that depend on the rate


@pytest.mark.parametrize("n", [1.0, 1.5, 2.0, 3.0])
def test_energy_of_nth_power_damping(n):
    c, omega, amplitude = 0.6, 3.0, 0.8
    factor = 2.0 * math.sqrt(math.pi) * gamma_function((n + 2.0) / 2.0) / gamma_function((n + 3.0) / 2.0)
    law = laws.TinkerCutchins(k1=1.0, k2=0.2, k3=0.5, c=c, n=n, smoothing=1e-3)
    # 400 cubics per cycle follow the sine to 1e-10.
    assert last_energy(law, amplitude, omega=omega) == pytest.approx(factor * c * omega**n * amplitude ** (n + 1.0), rel=1e-8)


def test_energy_of_variable_coulomb_friction_with_the_square_of_the_smoothing():
    f0, f1, f2, omega, amplitude = 0.5, 0.3, 0.2, 2.0, 1.5
    ideal = 4.0 * f0 * amplitude + 2.0 * f1 * amplitude**2 + 4.0 / 3.0 * f2 * amplitude**3
    sizes, lost = np.array([0.08, 0.04, 0.02, 0.01]), []
    for share in sizes:
        law = laws.TinkerCutchins(k1=1.0, f0=f0, f1=f1, f2=f2, smoothing=share * omega * amplitude)
        lost.append(1.0 - last_energy(law, amplitude, omega=omega, per_cycle=4000) / ideal)
    order = np.polyfit(np.log(sizes), np.log(lost), 1)[0]
    print("order", order, "lost", lost)
    assert order == pytest.approx(2.0, abs=0.02)
    # Around each of two reversals 2 Fc(A) int (1 - tanh(a t / s)) a t dt is lost, a = w^2 A: pi^2/12 Fc(A) s^2 / a.
    leading = math.pi**2 / 6.0 * (f0 + f1 * amplitude + f2 * amplitude**2) * amplitude * sizes[-1] ** 2 / ideal
    assert lost[-1] == pytest.approx(leading, rel=0.01)


def complex_stiffness(law, omega):
    """Return F / x of the settled response to a sine, by its first harmonic over the last of 12 cycles."""
    trace, last = steady(law, 1.0, omega=omega, cycles=12)
    x, force = trace.deflection[last][:-1], trace.force[last][:-1]
    wave = np.exp(-2j * np.pi * np.arange(x.size) / x.size)
    return (force * wave).sum() / (x * wave).sum()


@pytest.mark.parametrize("omega", [0.3, 1.0, 4.0])
def test_complex_stiffness_of_kelvin_voigt_and_zener(omega):
    # Sums over whole periods are exact; what is left is the cubic between samples and, for Zener's, exp(-12 T k1 / c).
    assert complex_stiffness(laws.KelvinVoigt(k=1.3, c=0.4), omega) == pytest.approx(1.3 + 0.4j * omega, rel=1e-9)
    k0, k1, c = 0.6, 1.4, 0.9
    expected = k0 + k1 * 1j * omega * c / (k1 + 1j * omega * c)
    assert complex_stiffness(laws.Zener(k0=k0, k1=k1, c=c), omega) == pytest.approx(expected, rel=1e-8)


def test_loss_factor_of_zener_is_largest_where_it_should_be():
    k0, k1, c = 0.6, 1.4, 0.9
    law = laws.Zener(k0=k0, k1=k1, c=c)
    best = k1 / c * math.sqrt(k0 / (k0 + k1))
    stiffness = {share: complex_stiffness(law, share * best) for share in (0.8, 0.99, 1.0, 1.01, 1.25)}
    loss = {share: value.imag / value.real for share, value in stiffness.items()}
    assert loss[1.0] == pytest.approx(k1 / (2.0 * math.sqrt(k0 * (k0 + k1))), rel=1e-8)
    assert max(loss.values()) == loss[1.0]
    # Frequencies with one geometric mean lose the same.
    assert loss[0.8] == pytest.approx(loss[1.25], rel=1e-8)


# Wear and pinching

WORN = {"alpha": 2.0, "beta": 0.7, "gamma": 0.3, "n": 1.5, "k": 0.4}


def test_baber_noori_without_wear_and_pinching_is_bouc_wen():
    for path in PATHS:
        worn, plain = laws.BoucWenBaberNoori(**WORN).trace(path), laws.BoucWen(**WORN).trace(path)
        # Two integrations to 1e-11 a step.
        np.testing.assert_allclose(worn.force, plain.force, rtol=0, atol=1e-9)
        np.testing.assert_allclose(worn.work, plain.work, rtol=0, atol=1e-9)


def test_wear_counts_the_work_of_z_and_softens_the_loop():
    law = laws.BoucWenBaberNoori(**WORN, delta_alpha=0.04)
    for path in PATHS:
        trace = law.trace(path)
        # What is not in the spring went through z.
        np.testing.assert_allclose(trace.internal_states[:, 1], trace.work - 0.5 * WORN["k"] * path**2, rtol=0, atol=1e-9)
    loops = [cyclic_test(law, 1.0, cycles=n)[0] for n in (2, 4, 16)]  # the first begins at rest
    stiffness = [loop.secant_stiffness for loop in loops]
    energy = [loop.dissipated_energy for loop in loops]
    assert stiffness[0] > stiffness[1] > stiffness[2] > WORN["k"]
    assert energy[0] > energy[1] > energy[2] > 0.0


def test_pinching_takes_most_of_the_slope_where_z_passes_its_place():
    pinched = {"zeta": 0.8, "q": 0.2, "p": 2.0, "psi": 0.15, "lam": 0.3}
    law = laws.BoucWenBaberNoori(**WORN, **pinched)
    up = np.linspace(-1.5, 1.5, 3001)
    trace = law.trace(np.concatenate([[0.0, 1.5], up]))
    x, (z, e) = up, trace.internal_states[2:].T
    slope, middle = np.diff(z) / np.diff(x), 0.5 * (z[1:] + z[:-1])
    plain = WORN["alpha"] - (WORN["gamma"] + WORN["beta"] * np.sign(middle)) * np.abs(middle) ** WORN["n"]
    share = slope / plain
    place = int(np.argmin(share))
    z_u = (WORN["alpha"] / (WORN["beta"] + WORN["gamma"])) ** (1.0 / WORN["n"])
    # The place of the deepest pinch and its depth s = zeta (1 - exp(-p e)); slopes by differences of 1e-3.
    assert middle[place] == pytest.approx(pinched["q"] * z_u, abs=2e-3)
    assert 1.0 - share[place] == pytest.approx(pinched["zeta"] * -math.expm1(-pinched["p"] * e[place]), rel=1e-3)
    assert share[0] > 0.95
    assert share[-1] > 0.95


@pytest.mark.parametrize("rest", [-0.6, 0.4])
@pytest.mark.parametrize("loss", [{}, {"loss": 0.4, "reversal": 0.1}, {"c": 0.3, "rounding": 0.2}])
def test_gaps_from_a_deflection_at_rest_are_those_of_a_path_that_is_shifted(rest, loss):
    given = {"gap_below": 0.3, "gap_above": 0.5, "k": 2.0, **loss}
    path, time = np.array([0.0, -1.4, 1.3, -0.9, 1.1, 0.0]), np.linspace(0.0, 5.0, 6)
    shifted = laws.Stop(**given).trace(path, time=time)
    installed = laws.Stop(**given, rest=rest).trace(path + rest, time=time)
    np.testing.assert_allclose(installed.force, shifted.force, rtol=0.0, atol=1e-12)  # rounding of the shifted path
    np.testing.assert_allclose(installed.work, shifted.work, rtol=1e-10, atol=1e-14)
    assert laws.Stop(**given, rest=rest).unloaded_gaps == pytest.approx({"below": 0.3 - rest, "above": 0.5 + rest})
