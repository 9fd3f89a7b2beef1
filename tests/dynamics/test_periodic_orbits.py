"""Periodic motions against published benchmarks, closed forms, and what cannot be."""

import numpy as np
import pytest
from house import sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.dynamics.periodic.shooting import MARGIN

pytestmark = pytest.mark.quick

BENCHMARK_ACCURACY = 1e-6  # 1280 steps per period: order 2 at the kinks leaves 3e-6 of the loop's energy


def orbit(law, omega, acceleration, *, accuracy=BENCHMARK_ACCURACY, mass=1.0, **more):
    return wr.periodic_orbit(
        sdof(law, mass=mass), frequency=omega / (2.0 * np.pi), acceleration=acceleration, direction="z",
        accuracy=accuracy, **more,
    )  # fmt: skip


def pure(beta, gamma):
    return wr.BoucWen(alpha=1.0, beta=beta, gamma=gamma, n=1.0)


def modified(k1, k2, k3, lam):
    parts = {"alpha": 1.0, "beta": 0.5, "gamma": 0.5, "n": 1.0, "k1": k1, "k2": k2, "k3": k3}
    return wr.AsymmetricBoucWen(**parts, b=np.exp(lam), c=1.0) if lam else wr.SymmetricBoucWen(**parts)


def loop(found):
    """Return deflection, force and z of the mount over one period, and the energy of the closed loop."""
    mount = found.response.mounts["m1"]
    deflection, force, z = (part[:-1, 2] for part in (mount.deflection, mount.force, mount.hysteretic_state))
    energy = 0.5 * np.sum((force + np.roll(force, -1)) * (np.roll(deflection, -1) - deflection))
    return deflection, force, z, energy


# beta, gamma, omega, then half range of d, z_max, energy, moduli of the multipliers: alpha = n = M = 1, base 0.3 m/s^2
# (domain facts 6.2, event-split DOP853)
PURE = [
    (0.5, 0.5, 0.5, 0.45896197, 0.40265818, 0.06308156, (0.59734, 0.59734)),
    (0.5, 0.5, 0.8, 1.32292920, 0.83627730, 1.24724792, (0.37284, 0.07189)),
    (0.5, 0.5, 1.5, 0.23013706, 0.21640770, 0.00808515, (0.78359, 0.78359)),
    (0.8, 0.2, 0.8, 1.05461054, 0.77129585, 0.95005770, (0.37471, 0.06524)),
    (0.8, 0.2, 1.0, 0.89536921, 0.70057849, 0.62483884, (0.21081, 0.21081)),
    (1.0, 0.0, 0.8, 0.93796753, 0.73428704, 0.81472194, (0.32081, 0.07317)),
    (0.5, -0.4, 0.8, 0.65363574, 0.72294920, 0.18020300, (0.56202, 0.56202)),
]


@pytest.mark.parametrize(("beta", "gamma", "omega", "half", "z_max", "energy", "moduli"), PURE)
def test_pure_bouc_wen_orbits_are_the_benchmarks_and_neutral_in_their_offset(beta, gamma, omega, half, z_max, energy, moduli):
    found = orbit(pure(beta, gamma), omega, 0.3)
    peak = found.response.peaks.mounts["m1"].deflection
    _, _, z, dissipated = loop(found)
    assert (peak.maximum[2] - peak.minimum[2]) / 2.0 == pytest.approx(half, rel=1e-5)
    assert z.max() == pytest.approx(z_max, rel=1e-5)
    assert dissipated == pytest.approx(energy, rel=1e-5)
    assert np.abs(found.floquet_multipliers) == pytest.approx(moduli, abs=1e-3)
    assert found.neutral == 1
    assert found.stable
    assert found.residual <= 1e-8


# k1, k2, k3, lambda, omega, acceleration, d_min, d_max, z_max, energy (domain facts 6.2, the modified law)
MODIFIED = [
    (0.1, 0.0, 0.0, 0.0, 0.8, 0.3, -1.17245244, 1.17245244, 0.78900135, 0.91128124),
    (0.1, 0.0, 0.0, 0.0, 1.0, 0.3, -1.08550092, 1.08550092, 0.75686469, 0.74170077),
    (0.1, 0.0, 0.0, 0.0, 0.5, 1.0, -5.26131962, 5.26131962, 0.99992683, 16.04571750),
    (0.1, 0.0, 0.0, 0.0, 1.0, 1.0, -1.98405277, 1.98405277, 0.95105465, 3.22748753),
    (0.5, 0.1, 0.05, 0.2, 0.8, 0.3, -0.35556769, 0.37984929, 0.33197992, 0.03280018),
    (0.5, 0.1, 0.05, 0.2, 1.0, 0.3, -0.81001739, 0.68422320, 0.59366449, 0.25865647),
    (0.5, 0.1, 0.05, 0.2, 0.8, 1.0, -1.50350412, 1.46598311, 0.87666184, 1.67092270),
]


@pytest.mark.parametrize(("k1", "k2", "k3", "lam", "omega", "acceleration", "lowest", "highest", "z_max", "energy"), MODIFIED)
def test_orbits_of_the_modified_law_are_the_benchmarks(k1, k2, k3, lam, omega, acceleration, lowest, highest, z_max, energy):
    found = orbit(modified(k1, k2, k3, lam), omega, acceleration)
    peak = found.response.peaks.mounts["m1"].deflection
    _, _, z, dissipated = loop(found)
    assert [peak.minimum[2], peak.maximum[2]] == pytest.approx([lowest, highest], rel=1e-5)
    assert np.abs(z).max() == pytest.approx(z_max, rel=1e-5)
    assert dissipated == pytest.approx(energy, rel=1e-5)
    assert found.neutral == 0
    assert found.stable
    assert np.abs(found.floquet_multipliers).max() <= 0.862  # "largest 0.861"


def test_the_determinant_of_the_monodromy_matrix_follows_the_amplitude():
    """For n = 1 and gamma = 0, z'' loses exp(-4 beta A) over a cycle, whatever the motion (domain facts 6.3)."""
    found = orbit(pure(1.0, 0.0), 0.5, 0.3)
    deflection, *_ = loop(found)
    product = np.prod(found.floquet_multipliers)
    assert product.real == pytest.approx(np.exp(-2.0 * np.ptp(deflection)), abs=1e-4)
    assert product.imag == pytest.approx(0.0, abs=1e-9)


def test_a_linear_mount_has_the_closed_form_and_its_multipliers():
    mass, k, c, omega, level = 3.5, 2.0e4, 60.0, 90.0, 4.0
    found = orbit(wr.KelvinVoigt(k=k, c=c), omega, level, mass=mass)
    transfer = (k + 1j * omega * c) / (k - mass * omega**2 + 1j * omega * c)
    peak = found.response.peaks.bodies["mass"].acceleration
    assert peak.maximum[2] == pytest.approx(level * abs(transfer), rel=1e-6)  # RK4 on a smooth problem; peaks refined
    poles = np.roots([mass, c, k])
    expected = np.exp(poles * 2.0 * np.pi / omega)
    assert sorted(found.floquet_multipliers, key=np.imag) == pytest.approx(sorted(expected, key=np.imag), abs=1e-6)


def test_two_periods_of_the_same_motion_have_squared_multipliers():
    once = orbit(modified(0.5, 0.1, 0.05, 0.2), 0.8, 1.0, accuracy=1e-5)
    twice = orbit(modified(0.5, 0.1, 0.05, 0.2), 0.8, 1.0, accuracy=1e-5, periods=2)
    assert twice.duration == pytest.approx(2.0 * once.duration)
    assert np.abs(twice.floquet_multipliers) == pytest.approx(np.abs(once.floquet_multipliers) ** 2, abs=1e-4)


def test_a_neighbour_is_found_from_a_guess_without_settling():
    law = modified(0.5, 0.1, 0.05, 0.2)
    first = orbit(law, 0.8, 1.0, accuracy=1e-4)
    second = wr.periodic_orbit(
        first.system, frequency=first.frequency * 1.01, acceleration=1.0, direction="z", guess=first.state
    )
    assert "settling" not in second.message
    settled = orbit(law, 0.8 * 1.01, 1.0, accuracy=1e-4)
    peaks = [found.response.peaks.mounts["m1"].deflection.value for found in (second, settled)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-7)


def test_the_response_of_an_orbit_closes():
    found = orbit(modified(0.5, 0.1, 0.05, 0.2), 0.8, 1.0, accuracy=1e-4)
    mount = found.response.mounts["m1"]
    scale = np.ptp(mount.deflection[:, 2])
    assert mount.deflection[-1, 2] == pytest.approx(mount.deflection[0, 2], abs=1e-7 * scale)
    assert found.response.time[-1] == pytest.approx(found.duration)


def test_weight_rests_on_the_elastic_share_alone():
    """Vibration lets the hysteretic share of the load leak away: the mean of z over a period is about zero."""
    law = wr.BoucWen(alpha=4.0e4, beta=200.0, gamma=200.0, n=1.0, k=2.0e4)
    found = wr.periodic_orbit(sdof(law, gravity=9.80665), frequency=12.0, acceleration=8.0, direction="z")
    deflection, _, z, _ = loop(found)
    assert abs(z.mean()) < 1e-2 * np.ptp(z)  # the loop is not quite symmetric in time
    assert deflection.mean() == pytest.approx(-3.5 * 9.80665 / 2.0e4, rel=2e-2)


def test_an_undamped_resonance_has_no_periodic_motion_and_says_so():
    law = wr.KelvinVoigt(k=1.0, c=0.0)
    with pytest.raises(wr.ConvergenceError, match=r"residual stays at .* after Newton's method .* not be periodic there"):
        orbit(law, 1.0, 0.3, accuracy=1e-4)


def test_travel_beyond_the_rating_is_refused_with_its_place():
    isolator = wr.Isolator(
        name="a", axial=modified(0.5, 0.1, 0.05, 0.2), limits=wr.Limits(travel=wr.Travel(compression=1.0, tension=1.0))
    )
    system = wr.load_system(sdof_text(mass=1.0), isolators={"a": isolator})
    with pytest.raises(
        wr.SimulationError, match=r"at 0\.127.* Hz.* mount 'm1' reaches 150\d mm in compression, rated for 1000 mm"
    ):
        wr.periodic_orbit(system, frequency=0.8 / (2 * np.pi), acceleration=1.0, direction="z")


def test_a_law_that_ends_is_named_when_the_motion_leaves_it():
    law = wr.BoucWen(alpha=1.0, beta=0.5, gamma=-2.0, n=2.0, k=0.5)  # beta + gamma < 0: infinite at a finite travel
    isolator = wr.Isolator(name="a", axial=law, limits=wr.Limits(travel=wr.Travel(compression=0.5, tension=0.5)))
    system = wr.load_system(sdof_text(mass=1.0), isolators={"a": isolator})
    with pytest.raises(wr.SimulationError, match="Mount 'm1' stood at .* whose law holds up to"):
        wr.periodic_orbit(system, frequency=0.1, acceleration=20.0, direction="z")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequency": 0.0}, "`frequency` must be > 0"),
        ({"acceleration": 0.0}, "`acceleration` must not be zero"),
        ({"direction": "up"}, "`direction` must be"),
        ({"periods": 0}, "`periods` must be an integer"),
        ({"periods": 1.5}, "`periods` must be an integer"),
        ({"accuracy": -1.0}, "`accuracy` must be > 0"),
        ({"history": "new"}, "`history` must be"),
    ],
)
def test_bad_arguments_are_named(change, message):
    with pytest.raises(ValueError, match=message):
        wr.periodic_orbit(sdof(pure(0.5, 0.5)), **{"frequency": 1.0, "acceleration": 1.0, "direction": "z"} | change)


def test_a_direction_without_a_slide_is_a_model_error():
    with pytest.raises(wr.ModelError, match="moves along x, but the base 'deck' has no driven slide"):
        wr.periodic_orbit(sdof(pure(0.5, 0.5)), frequency=1.0, acceleration=1.0, direction="x")


def test_an_axis_that_does_not_move_is_not_called_unstable():
    """A vertical motion leaves the horizontal states of a guided mass where they are: neutral or undamped, never unstable."""
    isolator = wr.Isolator(name="a", axial=modified(0.1, 0.0, 0.0, 0.0), roll=pure(0.5, 0.5), shear=pure(0.5, 0.5))
    free = sdof_text(mass=1.0).replace(
        '<joint name="mass_z" type="slide" axis="0 0 1"/>',
        '<joint name="mx" type="slide" axis="1 0 0"/><joint name="my" type="slide" axis="0 1 0"/>'
        '<joint name="mass_z" type="slide" axis="0 0 1"/>',
    )
    system = wr.load_system(free, isolators={"a": isolator})
    found = wr.periodic_orbit(system, frequency=0.8 / (2 * np.pi), acceleration=0.3, direction="z")
    assert found.neutral == 2  # the two offsets
    assert found.stable
    # No damping without motion; the finite disturbance of the difference quotients itself dissipates 1.4 %.
    assert 0.97 < np.abs(found.floquet_multipliers).max() <= 1.0 + MARGIN
