"""Roll and shear as one: the coupled law against its equation, closed forms, each axis alone, and on any path."""

import math

import numpy as np
import pytest
from examples_drawn import examples
from hypothesis import given
from hypothesis import strategies as st
from laws_for_tests import path_through
from scipy.integrate import solve_ivp

from wirerope_mj.mounts import laws

RNG = np.random.default_rng(7)
STRAIGHT = path_through(RNG.uniform(-2.0, 2.0, 15), per_segment=4)
PLANE_ROLL = {"z_max": 1.2, "x_y": 0.5, "sigma": 0.7}
PLANE_SHEAR = {"z_max": 0.8, "x_y": 0.9, "sigma": 0.7}


def plane(n, **elastic):
    """Return a coupled law with different axes."""
    roll, shear = (laws.BoucWen.from_normalised(**axis, n=n, **elastic) for axis in (PLANE_ROLL, PLANE_SHEAR))
    return laws.BiaxialBoucWen(roll=roll, shear=shear)


@pytest.mark.parametrize("n", [1.0, 2.0, 1.4])
def test_coupled_law_is_its_differential_equation(n):
    bound, yields = (np.array([axis[key] for axis in (PLANE_ROLL, PLANE_SHEAR)]) for key in ("z_max", "x_y"))
    sigma, k = 0.7, 0.3
    path = np.concatenate([[[0.0, 0.0]], RNG.uniform(-1.5, 1.5, (14, 2))])
    w, work, states, works = np.zeros(2), 0.0, [np.zeros(2)], [0.0]
    for start, stop in zip(path, path[1:], strict=False):
        length, at = float(np.linalg.norm(stop - start)), 0.0
        direction = (stop - start) / length
        u = direction / yields
        side = 1.0 if u @ w >= 0.0 else -1.0
        while at < length:

            def rates(at, y, u=u, side=side, start=start, direction=direction):
                w = y[:2]
                size = np.linalg.norm(w)
                pull = (sigma * side + 1.0 - sigma) * (u @ w) * (size ** (n - 2.0) if size > 0.0 else 0.0)
                return [*(u - w * pull), direction @ (bound * w + k * (start + at * direction))]

            def turning(_at, y, u=u):
                return u @ y[:2]

            turning.terminal, turning.direction = True, 1.0
            events = turning if side < 0.0 else None
            run = solve_ivp(rates, (at, length), [*w, work], method="DOP853", rtol=1e-12, atol=1e-14, events=events)
            assert run.success, run.message
            at, w, work, side = run.t[-1], run.y[:2, -1], run.y[2, -1], 1.0
        states.append(bound * w)
        works.append(work)
    trace = plane(n, k=k).trace(path)
    # Both are held to 1e-11 and 1e-12 a step; near w = 0 the unit vector w / |w| turns within a short length.
    np.testing.assert_allclose(trace.hysteretic_state, states, rtol=0, atol=1e-9)
    np.testing.assert_allclose(trace.force, k * path + states, rtol=0, atol=1e-9)
    np.testing.assert_allclose(trace.work, works, rtol=0, atol=1e-9)


@pytest.mark.parametrize("n", [1.0, 2.0, 1.4])
def test_coupled_law_is_each_axis_own_law_along_that_axis(n):
    roll = laws.BoucWen.from_normalised(z_max=1.2, x_y=0.5, sigma=0.7, n=n, k=0.3)
    shear = laws.SymmetricBoucWen.from_normalised(z_max=0.8, x_y=0.9, sigma=0.7, n=n, k1=0.2, k2=0.1, k3=0.4)
    law = laws.BiaxialBoucWen(roll=roll, shear=shear)
    still = np.zeros_like(STRAIGHT)
    for axis, own in enumerate((roll, shear)):
        trace = law.trace(np.stack([still, STRAIGHT] if axis else [STRAIGHT, still], axis=1))
        alone = own.trace(STRAIGHT)
        # Integrated in the plane to 1e-11 a step, in closed form along the axis.
        np.testing.assert_allclose(trace.force[:, axis], alone.force, rtol=0, atol=1e-9)
        np.testing.assert_allclose(trace.work, alone.work, rtol=0, atol=1e-9)
        assert not trace.force[:, 1 - axis].any()


def test_coupled_law_of_equal_axes_turns_with_its_path():
    axis = laws.BoucWen(alpha=2.0, beta=0.9, gamma=0.4, n=1.3, k=0.5)
    law, path = laws.BiaxialBoucWen(roll=axis, shear=axis), np.vstack([[0.0, 0.0], RNG.uniform(-1.5, 1.5, (20, 2))])
    turn = np.array([[math.cos(0.7), -math.sin(0.7)], [math.sin(0.7), math.cos(0.7)]])
    plain, turned = law.trace(path), law.trace(path @ turn.T)
    # The adaptive steps are those of components, which turn.
    np.testing.assert_allclose(turned.force, plain.force @ turn.T, rtol=0, atol=1e-9)
    np.testing.assert_allclose(turned.work, plain.work, rtol=0, atol=1e-9)
    assert np.linalg.norm(plain.hysteretic_state, axis=1).max() <= axis.z_max * (1.0 + 1e-9)


def test_a_saturated_coupled_force_turns_into_the_new_direction():
    """From w = (1, 0) across: w stays on the unit circle and its angle grows by cos(angle) per yield deflection."""
    z_max, x_y = 1.2, 0.5
    axis = laws.BoucWen.from_normalised(z_max=z_max, x_y=x_y, sigma=0.6, n=2.0)
    across = np.linspace(0.0, 3.0, 31)
    path = np.concatenate([[[0.0, 0.0]], np.stack([np.full(31, 10.0), across], axis=1)])
    z = laws.BiaxialBoucWen(roll=axis, shear=axis).trace(path).hysteretic_state[1:]
    # 20 yield deflections leave tanh(20) = 1 of the bound.
    np.testing.assert_allclose(z[:, 0], z_max / np.cosh(across / x_y), rtol=0, atol=1e-9)
    np.testing.assert_allclose(z[:, 1], z_max * np.tanh(across / x_y), rtol=0, atol=1e-9)


@st.composite
def planes(draw):
    """Return coupled laws; below sigma = 1/2 only axes of equal energy z_max x_y are passive."""
    sigma, n = draw(st.floats(0.3, 1.2)), draw(st.floats(0.3, 3.0))
    z, x = draw(st.tuples(st.floats(0.2, 3.0), st.floats(0.2, 3.0))), draw(st.floats(0.2, 3.0))
    other = draw(st.floats(0.2, 3.0)) if sigma >= 0.5 else z[0] * x / z[1]
    roll = laws.BoucWen.from_normalised(z_max=z[0], x_y=x, sigma=sigma, n=n, k=draw(st.floats(0.0, 1.0)))
    shear = laws.BoucWen.from_normalised(z_max=z[1], x_y=other, sigma=sigma, n=n, k=draw(st.floats(0.0, 1.0)))
    return laws.BiaxialBoucWen(roll=roll, shear=shear)


@given(
    law=planes(),
    points=st.lists(st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)), min_size=2, max_size=12),
    small=st.booleans(),
)
@examples(150)
def test_coupled_law_is_bounded_odd_passive_and_does_not_know_its_sampling(law, points, small):
    path = np.array([(0.0, 0.0), *points]) * (0.2 if small else 1.0)
    loop = law.trace(path)
    bounds = np.array([law.roll.z_max, law.shear.z_max])
    # The bound is approached, and passed by 1e-11 of an adaptive step.
    assert np.linalg.norm(loop.hysteretic_state / bounds, axis=1).max() <= 1.0 + 1e-9
    scale = max(np.abs(loop.force).max(), 1e-3)
    mirrored = law.trace(-path)
    np.testing.assert_allclose(mirrored.force, -loop.force, rtol=0, atol=1e-12 * scale)
    fine = np.concatenate([path[:1], *(np.linspace(a, b, 8)[1:] for a, b in zip(path, path[1:], strict=False))])
    finely = law.trace(fine)
    # For n < 1 the slope of the loop at w = 0 is not smooth.
    np.testing.assert_allclose(finely.force[::7], loop.force, rtol=0, atol=1e-8 * scale)
    assert finely.work.min() >= -1e-9 * max(1.0, np.abs(finely.work).max())
