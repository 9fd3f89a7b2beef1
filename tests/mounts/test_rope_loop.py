"""The elastica of a rope loop against closed forms, its own energy and its own symmetries."""

import numpy as np
import pytest
from rope_loops import ring
from scipy.special import ellipeinc, ellipkinc

from wirerope_mj.mounts.rope_loop.elastica import LARGEST_REACH, RopeLoop
from wirerope_mj.mounts.rope_loop.half_loop import HalfLoop, LoopShape, loop_shape

WR16_400 = {"height": 0.089, "width": 0.105, "bar": 0.0196, "rope": 0.0127}
SHAPE = loop_shape(**WR16_400)
LOOP = RopeLoop(SHAPE)
ROUNDING = 1e-9
"""Relative: Newton stops at 1e-10 of the directions, and a force is the sum of two halves of opposite signs."""


@pytest.mark.quick
def test_a_ring_has_the_stiffness_of_castigliano():
    radius = 0.04
    stiffness = RopeLoop(ring(radius)).stiffness() * radius**3
    # domain: 2 / (pi / 2 - 4 / pi) and 4 / pi; central differences of 1e-4 err by their square.
    assert stiffness[1, 1] == pytest.approx(2.0 / (np.pi / 2.0 - 4.0 / np.pi), rel=1e-6)
    assert stiffness[0, 0] == pytest.approx(4.0 / np.pi, rel=1e-6)


@pytest.mark.quick
def test_a_ring_turned_at_its_bar_has_the_stiffness_of_castigliano():
    """Moments and forces of a clamped half ring from its flexibility, integral of B^T B ds with B = (moment of unit loads)."""
    radius = 0.04
    angle, weight = np.polynomial.legendre.leggauss(40)
    angle = 0.5 * np.pi * (angle + 1.0)
    # Moment of unit forces in roll and axial direction and of a unit moment at the upper end (0, 2 R).
    arms = np.stack([2.0 * radius - radius * (1.0 - np.cos(angle)), radius * np.sin(angle), np.ones_like(angle)])
    flexibility = (arms * weight * 0.5 * np.pi * radius) @ arms.T
    half = np.linalg.inv(flexibility)
    both = 2.0 * half
    both[[0, 1, 2, 1], [1, 0, 1, 2]] = 0.0  # what the mirrored half cancels
    stiffness = RopeLoop(ring(radius)).stiffness()
    assert stiffness[2, 2] == pytest.approx(both[2, 2], rel=1e-6)
    assert abs(stiffness[0, 2]) == pytest.approx(abs(both[0, 2]), rel=1e-6)


def held_by_bars(shape, held):
    """Return a shape of which the bars hold a length [m] of both straight ends."""
    segments = list(shape.segments)
    for end in (0, -1):
        segments[end] = (segments[end][0] - held, 0.0)
    return LoopShape(segments=tuple(segments), arm=held)


def guided_strip(load, length):
    """Return shortening and sag of a straight strip, EI = 1, whose ends stay parallel under a transverse load.

    Each half is a cantilever under an end load (Bisshopp and Drucker 1945): with k^2 = (1 + sin a) / 2, a the slope of the
    inflection, and sin t = 1 / (k sqrt 2): F(k) - F(k, t) = l sqrt(P), d / l = 1 - 2 (E(k) - E(k, t)) / (l sqrt P).
    """
    from scipy.optimize import brentq

    half = 0.5 * length
    alpha = half * np.sqrt(load)

    def modulus(slope):
        m = 0.5 * (1.0 + np.sin(slope))
        return m, np.arctan2(1.0, np.sqrt(np.sin(slope)))  # sin t = 1 / (k sqrt 2), without loss of digits near pi / 2

    def lack(slope):
        m, start = modulus(slope)
        return ellipkinc(np.pi / 2, m) - ellipkinc(start, m) - alpha

    slope = brentq(lack, 1e-9, np.pi / 2 - 1e-9, xtol=1e-15)
    m, start = modulus(slope)
    sag = half * (1.0 - 2.0 * (ellipeinc(np.pi / 2, m) - ellipeinc(start, m)) / alpha)
    reach = half * np.sqrt(2.0 * np.sin(slope)) / alpha
    return 2.0 * reach - length, 2.0 * sag


@pytest.mark.parametrize("bent", [0.1, 1.0, 20.0, 60.0])
def test_a_straight_strip_bends_as_the_elliptic_integrals_say(bent):
    length = 0.3
    load = bent / length**2
    shortening, sag = guided_strip(load, length)
    strip = HalfLoop(LoopShape(segments=((length, 0.0),)), elements=40)
    # A straight inextensible rope cannot be compressed without a guess of the side to which it gives way.
    nodes = np.linspace(0.0, 1.0, len(strip.mesh.natural))
    guess = 6.0 * nodes * (1.0 - nodes) * np.arctan2(sag, length + shortening)
    goal = np.array([[shortening / length, sag / length, 0.0]])
    _, force, converged = strip.equilibrium(guess[None], np.array([[0.0, load * length**2]]), goal)
    assert converged.all()
    assert force[0, 1] == pytest.approx(load * length**2, rel=1e-6)
    assert abs(force[0, 0]) < 1e-6 * max(1.0, bent)  # no axial load: the ends were moved by just the shortening
    if bent == 0.1:  # small: 12 EI / L^3, to the square of the slope (0.004)
        assert load / sag == pytest.approx(12.0 / length**3, rel=1e-4)


@pytest.mark.parametrize("held", [0.0, 0.005])  # what the bars hold, as an arm
def test_the_force_is_the_gradient_of_the_energy(held):
    h = 0.089
    loop = RopeLoop(held_by_bars(SHAPE, held))
    points = np.array([[0.3 * h, -0.4 * h, 0.2], [-0.2 * h, 0.15 * h, -0.1], [0.1 * h, -0.6 * h, 0.0]])
    state = loop.state(*points.T)
    for axis, force in enumerate((state.roll_force, state.axial_force, state.moment)):
        step = np.zeros(3)
        step[axis] = 1e-5 if axis < 2 else 1e-4
        ends = [loop.state(*(points + sign * step).T).energy for sign in (1.0, -1.0)]
        slope = (ends[0] - ends[1]) / (2.0 * step[axis])
        # Central differences of 1e-4 of the loop: their own error is some 1e-7 of the largest force.
        np.testing.assert_allclose(slope, force, rtol=0.0, atol=2e-6 * np.abs(force).max())


@pytest.mark.quick
def test_both_sides_of_roll_are_alike():
    roll, axial, turn = np.array([0.01, 0.03]), np.array([-0.05, 0.02]), np.array([0.1, -0.2])
    one, other = LOOP.state(roll, axial, turn), LOOP.state(-roll, axial, -turn)
    np.testing.assert_allclose(one.energy, other.energy, rtol=ROUNDING)
    np.testing.assert_allclose(one.roll_force, -other.roll_force, rtol=ROUNDING)
    np.testing.assert_allclose(one.axial_force, other.axial_force, rtol=ROUNDING)
    np.testing.assert_allclose(one.moment, -other.moment, rtol=ROUNDING)


@pytest.mark.quick
def test_a_closed_path_costs_no_work():
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    roll, axial = 0.03 * np.sin(angle), -0.02 + 0.025 * np.cos(2.0 * angle)
    state = LOOP.state(roll, axial)
    rates = np.stack([0.03 * np.cos(angle), -0.05 * np.sin(2.0 * angle)])
    power = state.roll_force * rates[0] + state.axial_force * rates[1]
    work = power[:-1].mean() * 2.0 * np.pi  # the trapezoidal rule is exact to rounding on a smooth closed path
    assert abs(work) < 1e-9 * np.abs(power).max()
    assert np.ptp(state.energy) > 0.1 * state.energy.max()  # there was work to lose


@pytest.mark.slow
def test_halving_the_elements_divides_the_error_by_64():
    """Cubic elements: energy, and with it the force, err by the sixth power of their size."""
    points = np.array([[0.03, 0.0, 0.02], [-0.04, -0.05, 0.01], [0.1, 0.2, 0.0]])
    exact = RopeLoop(SHAPE, 128).state(*points)
    errors = [np.abs(RopeLoop(SHAPE, n).state(*points).axial_force / exact.axial_force - 1.0) for n in (12, 24, 48)]
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(orders > 5.5)
    assert np.all(errors[1] < 1e-7)


@pytest.mark.quick
def test_uniform_precurvature_changes_nothing_but_the_clamping_moment():
    """A rope bent into its shape by end moments alone: the same natural curvature less everywhere.

    Its energy differs by a constant and by a term linear in the angle between its ends, which the clamps keep.
    """
    half, flat = HalfLoop(SHAPE, 24), HalfLoop(SHAPE, 24)
    flat._bent = flat._bent - 0.5 * np.pi / 1.0 * (flat.mesh.slope.T @ flat.mesh.weight)
    moved, turn = np.array([[0.02, -0.04]]), np.array([0.0])
    bent, straighter = half.move(moved, turn), flat.move(moved, turn)
    np.testing.assert_allclose(straighter.force, bent.force, rtol=ROUNDING)
    assert abs(straighter.moment - bent.moment) > 1.0


@pytest.mark.quick
def test_a_loop_is_solved_from_deep_compression_to_nearly_taut():
    height = WR16_400["height"]
    nearly = (LARGEST_REACH - 0.002) * SHAPE.length - SHAPE.span[1]
    state = LOOP.state(0.0, np.array([-0.66 * height, -0.3 * height, 0.2 * height, 0.9 * nearly, nearly]))
    assert np.all(np.diff(state.axial_force) > 0.0)
    assert state.axial_force[-1] > 10.0 * abs(state.axial_force[0])  # compression ends at a plateau, tension does not
    with pytest.raises(ValueError, match="the rope is taut"):
        LOOP.state(0.0, 0.999 * SHAPE.taut())


@pytest.mark.parametrize(
    ("change", "words"),
    [({"height": -1.0}, "`height` must be"), ({"bar": 0.05}, "leaves no loop"), ({"width": 0.02}, "leaves no loop")],
)
def test_envelopes_that_hold_no_loop_are_refused(change, words):
    with pytest.raises(ValueError, match=words):
        loop_shape(**{**WR16_400, **change})


def test_a_shape_reaches_its_envelope():
    across, along = SHAPE.span
    assert across == pytest.approx(0.0, abs=1e-15)
    assert along == pytest.approx(WR16_400["height"] - WR16_400["bar"])
    tall = loop_shape(height=0.12, width=0.06, bar=0.01, rope=0.008)
    assert tall.span == pytest.approx((0.0, 0.11), abs=1e-15)
    assert sum(length * curvature for length, curvature in tall.segments) == pytest.approx(np.pi)
