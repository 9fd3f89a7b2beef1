"""Systems side by side: the functions of lanes, and every law's kernel in them against the same kernel of one system."""

import math
import operator
from dataclasses import replace

import numba
import numpy as np
import pytest

from tests.laws_for_tests import PARAMETERS, example
from wirerope_mj.foundation.lanes import WIDTH, count, lane, picked, power, raised, ranked, rows, some, where, with_lane
from wirerope_mj.mounts.laws import LAWS, Parallel, registry
from wirerope_mj.mounts.laws.plane_kernels import biaxial_rates, loop_force
from wirerope_mj.mounts.laws.wrapped import Smoothed

pytestmark = [
    pytest.mark.quick,
    pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="lanes are vectors of compiled code"),
]

EPS = np.finfo(np.float64).eps
N = 400
"""Samples of all lanes."""


def in_lanes(function, n_arguments):
    """Return a function of arrays (n, WIDTH) that applies `function` to their rows as lanes."""
    if n_arguments == 1:

        @numba.njit
        def one(x, result):
            a, r = rows(x), rows(result)
            for n in range(x.shape[0]):
                r[n] = function(a[n])

        run = one
    else:

        @numba.njit
        def two(x, y, result):
            a, b, r = rows(x), rows(y), rows(result)
            for n in range(x.shape[0]):
                r[n] = function(a[n], b[n])

        run = two

    def call(*arguments):
        shape = np.broadcast_shapes((1, WIDTH), *(np.shape(one) for one in arguments))
        result = np.full(shape, np.nan)
        run(*(np.ascontiguousarray(np.broadcast_to(one, shape)) for one in arguments), result)
        return result

    return call


def of_many_sizes(low, high, *, signs=True, seed=3):
    """Return numbers (N, WIDTH) of sizes from 10^low to 10^high, of both signs."""
    rng = np.random.default_rng(seed)
    size = 10.0 ** rng.uniform(low, high, (N, WIDTH))
    return size * rng.choice([-1.0, 1.0], size.shape) if signs else size


# NumPy's functions are good to an ulp (EPS of the result at most). The series and their sums are rounded a few times;
# of exp(x) - 1 and (1 - e) / (1 + e) what is left is 0.39 of what is subtracted, at least.
@pytest.mark.parametrize(
    ("function", "reference", "x", "ulp"),
    [
        (
            math.exp,
            np.exp,
            np.concatenate([np.clip(of_many_sizes(-20, 2.85), -708.0, 709.0), of_many_sizes(-3, 1)]),
            3.0,
        ),
        (
            math.log,
            np.log,
            np.concatenate([of_many_sizes(-307, 308, signs=False), 1.0 + of_many_sizes(-15, -0.1)]),
            3.0,
        ),
        (math.expm1, np.expm1, np.concatenate([of_many_sizes(-300, 2.8), of_many_sizes(-2, 1)]), 5.0),
        (math.tanh, np.tanh, np.concatenate([of_many_sizes(-300, 3), of_many_sizes(-2, 1)]), 6.0),
    ],
)
def test_elementary_functions_are_good_to_a_few_ulp(function, reference, x, ulp):
    np.testing.assert_allclose(in_lanes(function, 1)(x), reference(x), rtol=ulp * EPS)


def test_the_exponential_stays_where_floats_end():
    x = np.array([-np.inf, -1e300, -709.0, -708.0, 709.0, 710.0, 1e300, np.inf]).reshape(-1, WIDTH)
    # Between them no law has an argument; what counts is that nothing wraps round to the other end.
    np.testing.assert_allclose(in_lanes(math.exp, 1)(x).ravel(), [math.exp(-708.0)] * 4 + [math.exp(709.0)] * 4, rtol=3.0 * EPS)


@pytest.mark.parametrize("n", [0.05, 0.5, 1.2, 3.0, 100.0, -0.25, 0.0])
def test_powers_are_good_to_the_rounding_of_their_logarithm(n):
    x = of_many_sizes(-3, 3, signs=False)
    # exp(n ln x): what the product is rounded by, half an EPS of it, and the logarithm's own ulp are relative to the power.
    ulp = 4.0 + 4.0 * np.abs(n * np.log(x))
    for function in (power, raised):
        assert (np.abs(in_lanes(function, 2)(x, n) / x**n - 1.0) <= ulp * EPS).all()


def test_powers_of_common_exponents_need_no_logarithm():
    x = of_many_sizes(-300, 300, signs=False)
    n = np.resize([1.0, 2.0, 1.5], x.shape)
    with np.errstate(over="ignore", under="ignore"):
        expected = np.select([n == 1.0, n == 2.0], [x, x * x], x * np.sqrt(x))
    np.testing.assert_array_equal(in_lanes(power, 2)(x, n), expected)
    for n in ([1.0, 2.0, 1.5, 0.3], [1.2, 3.0, 100.0, 7.0]):
        np.testing.assert_array_equal(in_lanes(power, 2)(0.0, n), [[0.0] * WIDTH])


@pytest.mark.parametrize("function", [math.exp, math.expm1, math.tanh, math.sqrt, power], ids=lambda f: f.__name__)
def test_what_is_no_number_stays_none(function):
    x = np.where(np.arange(WIDTH) % 3 == 1, np.nan, 0.3)[None]
    result = in_lanes(function, 2)(x, EXPONENTS) if function is power else in_lanes(function, 1)(x)
    np.testing.assert_array_equal(np.isnan(result), np.isnan(x))


@pytest.mark.parametrize("function", [math.sqrt, math.floor, abs, operator.neg], ids=lambda f: f.__name__)
def test_functions_of_one_instruction_are_exact(function):
    x = of_many_sizes(-3, 5, signs=function is not math.sqrt)
    reference = {"sqrt": np.sqrt, "floor": np.floor}.get(function.__name__, function)
    np.testing.assert_array_equal(in_lanes(function, 1)(x), reference(x))


@pytest.mark.parametrize(
    "function", [operator.add, operator.sub, operator.mul, operator.truediv, min, max], ids=lambda f: f.__name__
)
def test_arithmetic_is_that_of_floats(function):
    x, y = of_many_sizes(-3, 3), of_many_sizes(-3, 3, seed=4)
    y[::5] = x[::5]
    expected = [[function(a, b) for a, b in zip(*both, strict=True)] for both in zip(x, y, strict=True)]
    np.testing.assert_array_equal(in_lanes(function, 2)(x, y), expected)


@pytest.mark.parametrize("name", ["lt", "le", "gt", "ge", "eq", "ne"])
def test_comparisons_choose_as_they_do_of_floats(name):
    compare = getattr(operator, name)
    x, y = of_many_sizes(-1, 1), of_many_sizes(-1, 1, seed=4)
    y[::3], x[5], y[6] = x[::3], np.nan, np.nan
    chosen = in_lanes(numba.njit(lambda a, b: where(compare(a, b), a, 7.0)), 2)(x, y)
    np.testing.assert_array_equal(chosen, np.where(compare(x, y), x, 7.0))


def test_masks_combine_and_say_whether_any_lane_holds():
    @numba.njit
    def choose(x, result):
        a, r = rows(x), rows(result)
        for n in range(x.shape[0]):
            low, high = a[n] < -1.0, a[n] > 1.0
            r[n] = where(low | high, 1.0, 0.0) + where((a[n] > 0.0) & high, 2.0, 0.0) + (4.0 if some(high) else 0.0)

    x = of_many_sizes(-1, 0.05)
    result = np.empty_like(x)
    choose(x, result)
    any_high = (x > 1.0).any(axis=1)[:, None]
    assert 0 < any_high.sum() < N
    np.testing.assert_array_equal(result, 1.0 * (np.abs(x) > 1.0) + 2.0 * (x > 1.0) + 4.0 * any_high)


def test_entries_are_reached_one_by_one_and_in_different_rows():
    @numba.njit
    def reach(p, x, result):
        a, b, r = rows(p), rows(x), rows(result)
        for n in range(x.shape[0]):
            place = ranked(a, 1, count(a, 0), b[n])
            r[3 * n] = place
            r[3 * n + 1] = picked(a, 1, max(place - 1, 0))
            r[3 * n + 2] = with_lane(b[n], 3, lane(b[n], 2))

    rng = np.random.default_rng(2)
    p = np.vstack([np.full(WIDTH, 6.0), np.sort(rng.normal(size=(6, WIDTH)), axis=0)])
    x = np.vstack([rng.normal(size=(N, WIDTH)), p[1:], np.full((2, WIDTH), [[-9.0], [9.0]])])
    result = np.empty((3 * len(x), WIDTH))
    reach(p, x, result)
    for number, one in enumerate(x):
        place = ranked(p, 1, count(p, 0), one)  # the same functions of NumPy's rows
        expected = [place, picked(p, 1, np.maximum(place - 1, 0)), with_lane(one, 3, lane(one, 2))]
        np.testing.assert_array_equal(result[3 * number : 3 * number + 3], expected)


GAPS = {"gap_below": 2e-3, "gap_above": 4e-3}
POINTS = {"depths": (1e-3, 3e-3, 6e-3), "forces": (100.0, 700.0, 4000.0)}
EXPONENTS = (1.0, 2.0, 1.2, 0.6)
"""One for each lane: those that have code of their own, and others, beside each other."""

WITHOUT = {"stop": ("rounding", "c"), "bouc-wen-baber-noori": ("zeta", "q", "p", "psi", "delta_psi", "lam")}
"""What some lanes are without beside others that have it: its width is zero there, by which the others divide."""


def varied(law):
    """Return laws for all lanes of the same structure as `law` with different parameters."""
    rng = np.random.default_rng(len(law.name))
    laws = []
    for number in range(WIDTH):
        if isinstance(law, Parallel):
            laws.append(Parallel(laws=tuple(varied(part)[number] for part in law.laws)))
            continue
        if isinstance(law, Smoothed):
            laws.append(replace(law, law=varied(law.law)[number], width=law.width * (1.0 + number)))
            continue
        whole, changes = rng.uniform(0.8, 1.25), {}
        for key, value in law.to_dict().items():
            if isinstance(value, list):
                changes[key] = [whole * one for one in value]
            elif key == "n":
                changes[key] = EXPONENTS[number]
            elif key == "exponent":
                changes[key] = value if law.depths else max(EXPONENTS[number], 1.0)
            elif isinstance(value, float):
                changes[key] = value * rng.uniform(0.8, 1.0 if key == "loss" else 1.25)
        if number % 4 == 3:
            changes |= dict.fromkeys(WITHOUT.get(law.name, ()), 0.0)
        laws.append(replace(law, **changes))
    return laws


CASES = {name: example(name) for name in PARAMETERS}
CASES |= {
    "hard stop": LAWS["stop"](**GAPS, k=4e6),
    "lossy stop of one side": LAWS["stop"](gap_above=1e-3, k=4e6, exponent=1.5, loss=0.9, reversal=1e-3),
    "stop through points": LAWS["stop"](**GAPS, **POINTS, rounding=1e-3, c=50.0),
    "lossy stop through points": LAWS["stop"](gap_below=0.0, **POINTS, loss=0.5, reversal=1e-3),
    "unpinched": example("bouc-wen-baber-noori", zeta=0.0),
}
CASES["parallel"] = Parallel(
    laws=tuple(CASES[name] for name in ("masing", "lossy stop of one side", "zener", "hard stop", "masing", "bouc-wen"))
)
CASES |= {
    f"smoothed {name}": Smoothed(law=CASES[name], width=0.02)
    for name in ("bouc-wen", "symmetric-bouc-wen", "asymmetric-bouc-wen", "vaiana-rosati", "tabulated")
}


@numba.njit
def of_lanes(law, p, x, v, z, force, rates):
    one, deflection, rate, result = rows(p), rows(x), rows(v), rows(force)
    for n in range(x.shape[0]):
        result[n] = registry.evaluate(law, one, 0, deflection[n], rate[n], rows(z[n]), 0, rows(rates[n]), 0)


@numba.njit
def of_one(law, p, x, v, z, force, rates):
    for n in range(x.size):
        force[n] = registry.evaluate(law, p, 0, x[n], v[n], z[n], 0, rates[n], 0)


def states_for(law, corners):
    """Return deflections, rates (N, WIDTH) and states (N, n_states, WIDTH), some on corners and at rest."""
    rng = np.random.default_rng(7)
    n_states = max(law.n_states, 1)
    x = rng.uniform(-1.0, 1.0, (N, WIDTH)) * rng.choice([0.08, 0.01], (N, 1))
    x[: len(corners)] = corners
    v = rng.normal(size=(N, WIDTH)) * rng.choice([1.0, 0.01], (N, WIDTH))
    v[::7], v[3::7] = 0.0, rng.choice([-0.0, 0.0, 0.1, -0.1], v[3::7].shape)
    z = rng.normal(size=(N, n_states, WIDTH)) * 200.0
    z[::11], z[1::11, 0] = 0.0, 0.0
    for number, name in enumerate(law.state_names):
        if name.endswith("w"):  # the state of a stop's loss
            z[:, number] = np.clip(z[:, number], -1.0, 1.0)
        elif name.endswith("e"):  # a work
            z[:, number] = np.abs(z[:, number]) / 50.0
    return x, v, z


def case(name):
    """Return the law's number, parameters (n_p, WIDTH), deflections, rates and states of a case."""
    laws = varied(CASES[name])
    p = np.array([law.kernel_parameters() for law in laws]).T.copy()
    corners = [np.zeros(WIDTH)]
    for stops in zip(*(law.components for law in laws), strict=True):
        for key, sign in (("gap_below", -1.0), ("gap_above", 1.0)):
            if getattr(stops[0], key, None) is not None:
                gaps = np.array([getattr(stop, key) for stop in stops])
                corners += [sign * gaps, sign * (gaps + np.array([stop.rounding for stop in stops]))]
    if hasattr(laws[0], "deflection"):
        corners += list(np.array([law.deflection for law in laws]).T)
    return CASES[name].kernel, p, *states_for(CASES[name], corners)


def run_lanes(kernel, p, x, v, z):
    force, rates = np.full(x.shape, np.nan), np.zeros(z.shape)
    of_lanes(kernel, p, x, v, z, force, rates)
    return force, rates


@pytest.mark.parametrize("name", CASES)
def test_laws_in_lanes_are_those_of_one_system(name):
    kernel, p, x, v, z = case(name)
    force, rates = run_lanes(kernel, p, x, v, z)
    for number in range(WIDTH):
        expected, slopes = np.full(N, np.nan), np.zeros(z.shape[:2])
        own = [np.ascontiguousarray(one[..., number]) for one in (p, x, v, z)]
        of_one(kernel, *own, expected, slopes)
        assert np.isfinite(expected).all()
        # The largest force, and the largest rate of a state, are the scale: where products are fused with their sums a dozen
        # terms of that size are rounded once less. exp and tanh are good to 3 and 6 ulp, and |z|^n to n ln |z| of them, 20
        # for the cube of 700 N.
        np.testing.assert_allclose(force[:, number], expected, rtol=0.0, atol=16.0 * EPS * np.abs(expected).max())
        assert (np.abs(rates[:, :, number] - slopes) <= 32.0 * EPS * np.abs(slopes).max(axis=0)).all()


@pytest.mark.parametrize("name", CASES)
def test_a_lane_does_not_depend_on_its_company(name):
    kernel, p, x, v, z = case(name)
    in_company = run_lanes(kernel, p, x, v, z)
    for number in range(WIDTH):
        alone = [np.repeat(one[..., number : number + 1], WIDTH, axis=-1) for one in (p, x, v, z)]
        others = [one for one in range(WIDTH) if one != number]
        for wild in (None, 1e300, np.nan):
            if wild is not None:
                for one in alone[1:]:
                    one[..., others] = wild
            for one, expected in zip(run_lanes(kernel, *alone), in_company, strict=True):
                assert one[..., number].tobytes() == expected[..., number].tobytes()


@pytest.mark.parametrize("name", ["masing", "parallel"])
def test_sliders_are_held_in_lanes(name):
    @numba.njit
    def hold(law, p, z):
        for n in range(z.shape[0]):
            registry.hold_slips(law, rows(p), 0, rows(z[n]), 0)

    @numba.njit
    def hold_one(law, p, z):
        for n in range(z.shape[0]):
            registry.hold_slips(law, p, 0, z[n], 0)

    kernel, p, _, _, z = case(name)
    held = z.copy()
    hold(kernel, p, held)
    assert not np.array_equal(held, z)
    for number in range(WIDTH):
        expected = np.ascontiguousarray(z[..., number])
        hold_one(kernel, np.ascontiguousarray(p[:, number]), expected)
        np.testing.assert_array_equal(held[..., number], expected)


def test_coupled_axes_in_lanes_are_those_of_one_system():
    @numba.njit
    def coupled(p, q, x, z, result):
        for n in range(x.shape[0]):
            a, rates = rows(x[n]), rows(result[n])
            biaxial_rates(rows(p), 0, a[0], a[1], rows(z[n]), 0, 1, rates, 0, 1)
            rates[2], rates[3] = loop_force(rows(q), 0, a[2], a[3])

    @numba.njit
    def coupled_one(p, q, x, z, result):
        for n in range(x.shape[0]):
            a, rates = x[n], result[n]
            biaxial_rates(p, 0, a[0], a[1], z[n], 0, 1, rates, 0, 1)
            rates[2], rates[3] = loop_force(q, 0, a[2], a[3])

    rng = np.random.default_rng(4)
    axes = [[0.7, n, 200.0, 300.0, 1e-3, 2e-3] * rng.uniform(0.8, 1.25, 6) ** [1, 0, 1, 1, 1, 1] for n in EXPONENTS]
    p = np.array(axes).T.copy()
    q = rng.normal(size=(12, WIDTH))
    q[:6] = np.array([[0.02, 0.03, 0.04, 0.03, 2.0, 3.0]]).T
    x, z = rng.normal(size=(N, 4, WIDTH)) * [[0.1], [0.1], [0.03], [0.04]], rng.normal(size=(N, 2, WIDTH)) * 200.0
    z[::5], z[1::7, :, ::2] = 0.0, 0.0
    result = np.empty((N, 4, WIDTH))
    coupled(p, q, x, z, result)
    for number in range(WIDTH):
        own = [np.ascontiguousarray(one[..., number]) for one in (p, q, x, z)]
        expected = np.empty((N, 4))
        coupled_one(*own, expected)
        # As above; Horner's schemes and the vector's length are rounded some ten times.
        assert (np.abs(result[..., number] - expected) <= 32.0 * EPS * np.abs(expected).max(axis=0)).all()
        alone = np.empty((N, 4, WIDTH))
        coupled(*(np.repeat(one[..., number : number + 1], WIDTH, axis=-1) for one in (p, q, x, z)), alone)
        assert (alone.view(np.int64) == result[..., number : number + 1].copy().view(np.int64)).all()
