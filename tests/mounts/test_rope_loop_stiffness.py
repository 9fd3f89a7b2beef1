"""Closed forms of the ring out of its plane, loops spread along a bar, and the energy that couples roll and axial direction."""

import numpy as np
import pytest
from rope_loops import coupling_error, ring

from wirerope_mj.mounts.rope_loop import (
    RopeLoop,
    fit_coupling,
    loop_positions,
    loop_shape,
    rotational_stiffness,
)

SHAPE = loop_shape(height=0.089, width=0.105, bar=0.0196, rope=0.0127)
COMPRESSION, ROLL = 0.0432, 0.0452  # rated travels of WR16-400


def ring_stiffness(radius, bending, torsion, loops=1.0):
    """Return compression, roll and shear of clamped rings [N/m] by Castigliano's theorem, two half rings in parallel each."""
    unit, mu = 2.0 * loops / radius**3, torsion / bending
    compression, roll = unit * bending / (np.pi / 2.0 - 4.0 / np.pi), unit * bending / (np.pi / 2.0)
    return compression, roll, unit * torsion / (np.pi - 8.0 / np.pi / (1.0 + mu))


def test_ring_formulas():
    compression, roll, shear = ring_stiffness(0.05, 2.0, 2.0 / 1.3, loops=3)
    unit = 3 * 2.0 / 0.05**3
    # 6.7214, 1.2732 and 0.9038 (GJ / EI = 1 / (1 + nu), nu = 0.3) are the classic figures, to their four digits.
    assert compression / unit == pytest.approx(6.7214, abs=1e-4)
    assert roll / unit == pytest.approx(1.2732, abs=1e-4)
    assert shear / unit == pytest.approx(0.9038, abs=1e-4)
    matrix = RopeLoop(ring(0.05)).stiffness()
    assert 6.0 * matrix[1, 1] == pytest.approx(compression, rel=1e-6)
    assert 6.0 * matrix[0, 0] == pytest.approx(roll, rel=1e-6)


def test_out_of_plane_ring_by_its_flexibility():
    """Shear of a clamped half ring: bending and torsion of unit loads at its end, ends not free to turn."""
    radius, bending, torsion = 0.05, 2.0, 1.2
    angle, weight = np.polynomial.legendre.leggauss(60)
    angle, weight = 0.5 * np.pi * (angle + 1.0), 0.5 * np.pi * weight * radius
    place = radius * np.stack([np.sin(angle), 1.0 - np.cos(angle)])
    along = np.stack([np.cos(angle), np.sin(angle)])  # tangent
    # Moment vector in the plane of the ring: of a unit force out of it at (0, 2 R), and of unit moments about x and z.
    lever = np.array([[0.0], [2.0 * radius]]) - place
    moments = [np.stack([-lever[1], lever[0]]), np.stack([np.ones_like(angle), 0 * angle])]
    moments.append(np.stack([0 * angle, np.ones_like(angle)]))
    twist = np.stack([np.sum(m * along, axis=0) for m in moments])
    bend = np.stack([m[0] * along[1] - m[1] * along[0] for m in moments])
    flexibility = (twist * weight) @ twist.T / torsion + (bend * weight) @ bend.T / bending
    shear = 2.0 * np.linalg.inv(flexibility)[0, 0]
    formula = ring_stiffness(radius, bending, torsion)[2]
    assert formula == pytest.approx(shear, rel=1e-9)  # both are exact; the quadrature is of smooth functions


def test_rotational_stiffness_is_that_of_hand_formulas():
    positions = loop_positions(8, 0.216)
    assert np.diff(positions) == pytest.approx(0.027)
    spread = 0.216**2 * (8**2 - 1) / (12 * 8**2)  # variance of evenly spread points
    found = rotational_stiffness(SHAPE, bending_stiffness=0.6, positions=positions, axial=5e5, roll=1e5)
    assert found[0] == pytest.approx(5e5 * spread)
    assert found[2] == pytest.approx(1e5 * spread)
    own = rotational_stiffness(SHAPE, bending_stiffness=0.6, positions=positions)
    matrix = 8 * 0.6 * RopeLoop(SHAPE).stiffness()
    assert own[[0, 2]] == pytest.approx(np.diag(matrix)[[1, 0]] * spread)


def test_a_ring_turns_about_its_middle_as_its_elastic_centre_says():
    """Each half ring: EI / (pi R) about its elastic centre, 2 R / pi beside the middle, which moves up and down there."""
    radius = 0.04
    found = rotational_stiffness(ring(radius), bending_stiffness=3.0, positions=[0.0])
    halves = 1.0 / np.pi + (2.0 / np.pi) ** 2 / (np.pi / 2.0 - 4.0 / np.pi)
    assert found[1] == pytest.approx(2.0 * 3.0 * halves / radius, rel=1e-6)
    assert found[0] == found[2] == 0.0  # one loop in the middle


def test_turn_and_deflection_do_not_act_on_each_other_at_mid_height():
    matrix = RopeLoop(SHAPE).stiffness()
    assert matrix[0, 2] + 0.5 * SHAPE.span[1] * matrix[0, 0] == pytest.approx(0.0, abs=1e-7 * abs(matrix[0, 2]))


@pytest.mark.parametrize(
    ("change", "words"),
    [({"positions": [0.0, 0.1]}, "from the middle"), ({"axial": -1.0}, "`axial`"), ({"positions": []}, "one row")],
)
def test_rotational_stiffness_refuses(change, words):
    with pytest.raises(ValueError, match=words):
        rotational_stiffness(SHAPE, **{"bending_stiffness": 1.0, "positions": [-0.1, 0.1], **change})


@pytest.fixture(scope="module")
def fit():
    return fit_coupling(SHAPE, bending_stiffness=0.63, loops=8, roll=ROLL, compression=COMPRESSION, tension=COMPRESSION)


def test_the_polynomial_has_the_forces_of_the_elastica(fit):
    assert coupling_error(fit, SHAPE, 8 * 0.63) < 0.02  # what a mount's coupling should be known to
    loop = RopeLoop(SHAPE)
    share = 0.0305  # of 61 mm at 45 degrees
    both = loop.state([share, share, 0.0], [-share, 0.0, -share])
    exact = 8 * 0.63 * np.array([both.roll_force[0] - both.roll_force[1], both.axial_force[0] - both.axial_force[2]])
    largest = np.abs(exact).max()
    np.testing.assert_allclose(fit.force([share, -share]), exact, atol=0.03 * largest)
    energy = 8 * 0.63 * (both.energy[0] - both.energy[1] - both.energy[2])
    assert fit.energy([share, -share]) == pytest.approx(energy, rel=0.03)


def test_more_terms_are_nearer_and_fewer_are_not_enough(fit):
    ranges = {"roll": ROLL, "compression": COMPRESSION, "tension": COMPRESSION}
    fewer = fit_coupling(SHAPE, bending_stiffness=0.63, loops=8, terms=(3, 5), **ranges)
    more = fit_coupling(SHAPE, bending_stiffness=0.63, loops=8, terms=(4, 8), **ranges)
    errors = [coupling_error(one, SHAPE, 8 * 0.63) for one in (more, fit, fewer)]
    assert errors == sorted(errors)
    assert errors[1] < 0.02 < errors[2]


def test_the_coupling_force_is_a_gradient_and_vanishes_on_the_axes(fit):
    coupling, step = fit, 1e-6
    places = np.array([[0.02, -0.03], [-0.04, -0.01], [0.03, 0.02]])
    slopes = [(coupling.energy(places + way) - coupling.energy(places - way)) / (2.0 * step) for way in step * np.eye(2)]
    force = coupling.force(places)
    np.testing.assert_allclose(np.stack(slopes, axis=-1), force, atol=1e-6 * np.abs(force).max())
    np.testing.assert_array_equal(coupling.energy([[0.0, -0.02], [0.03, 0.0]]), 0.0)
    assert coupling.force([0.0, -0.02])[1] == 0.0
    assert coupling.force([0.03, 0.0])[0] == 0.0


def test_tension_ends_before_the_rope_is_taut(fit):
    assert fit.tension < COMPRESSION
    reach = np.hypot(ROLL, SHAPE.span[1] + fit.tension) / SHAPE.length
    assert reach == pytest.approx(0.85)
    with pytest.raises(ValueError, match="not fitted so far"):
        fit_coupling(SHAPE, bending_stiffness=1.0, loops=1, roll=0.12, compression=0.04, tension=0.01)
    with pytest.raises(ValueError, match="`compression` must be"):
        fit_coupling(SHAPE, bending_stiffness=1.0, loops=1, roll=0.04, compression=-0.04, tension=0.01)
