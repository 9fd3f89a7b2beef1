"""Bump stops of the models of the house: where they close, what they carry, and that contacts say nearly the same."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.foundation.resources import models_folder

G = wr.STANDARD_GRAVITY


def hard_shock():
    return wr.HalfSine(peak=60.0 * G, duration=0.011, direction="z", start=0.05)


def table(name):
    return wr.simulate(wr.load_system(models_folder() / name), hard_shock(), duration=0.12, timestep=1e-5)


def test_contacts_and_stops_of_one_table_say_nearly_the_same():
    """The same gap, k and c: what differs is the first millimetre, and what MuJoCo makes of k."""
    stops = table("shock_table.xml")  # without a warning
    assert stops.peaks.struck == ["s1", "s2", "s3", "s4"]
    with pytest.warns(wr.AccuracyWarning, match="4 of 4 contact pairs were struck"):
        contacts = table("shock_table_contacts.xml")
    peaks = [r.peaks.bodies["block"].acceleration.value for r in (stops, contacts)]
    depths = [-r.peaks.mounts["m1"].deflection.minimum[2] - 0.0401 for r in (stops, contacts)]
    print("peaks", np.array(peaks) / G, "depths", depths)
    # 0.3 % in k, which four contacts of one body share, act on the peak; half a millimetre of soft rubber is half a
    # millimetre on the way, and 50 kg at 60 g have the energy for 8.7 mm
    assert peaks[0] == pytest.approx(peaks[1], rel=5e-3)
    assert depths[0] - depths[1] == pytest.approx(0.5e-3, abs=0.1e-3)
    force = [stops.peaks.mounts["s1"].force.minimum[2], -contacts.peaks.contacts["stop_1 on pad_1"].force]
    assert force[0] == pytest.approx(force[1], rel=5e-3)
    assert stops.peaks.mounts["s1"].force.maximum[2] == 0.0  # it never pulls, and no refined peak says so


def test_a_struck_stop_keeps_the_accuracy_that_is_asked_for():
    """Contacts do not: see test_timestep. A warning of accuracy is an error here."""
    system = wr.load_system(models_folder() / "shock_table.xml")
    r = wr.simulate(system, hard_shock(), duration=0.12, accuracy=1e-4)
    fine = table("shock_table.xml")
    assert r.estimated_error <= 1e-4
    wanted = fine.peaks.bodies["block"].acceleration.value
    assert r.peaks.bodies["block"].acceleration.value == pytest.approx(wanted, rel=1e-4)
    for name in ("m1", "s1"):
        force = fine.peaks.mounts[name].force
        np.testing.assert_allclose(r.peaks.mounts[name].force.minimum, force.minimum, atol=1e-4 * force.value)


def heavy(name, factor, isolators=None):
    """Return a model of the house under a multiple of gravity."""
    text = (models_folder() / name).read_text()
    assert text.count('gravity="0 0 -9.80665"') == 1
    return wr.load_system(text.replace('gravity="0 0 -9.80665"', f'gravity="0 0 {-factor * G}"'), isolators=isolators)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "factor", "mass", "wanted"),
    [
        ("floating_floor.xml", 9.0, 3300.0, [f"s{i:02d}" for i in range(1, 9)]),
        ("cabinet.xml", 20.0, 850.0, ["b1", "b4"]),  # it leans forward, away from the bulkhead
        ("shock_table.xml", 12.0, 50.0, ["s1", "s2", "s3", "s4"]),
    ],
)
def test_a_payload_too_heavy_for_its_mounts_rests_on_its_stops_and_stays_there(name, factor, mass, wanted):
    system = heavy(name, factor)
    e = wr.equilibrium(system)
    stops = [mount for mount in system.mounts.values() if mount.isolator.is_stop]
    pressed = [mount.name for mount in stops if e.mounts[mount.name].force[2] < 0.0]
    assert pressed == wanted
    for mount in stops:
        depth = -e.mounts[mount.name].deflection[2] - mount.isolator.axial.gap_below
        assert -e.mounts[mount.name].force[2] == pytest.approx(mount.isolator.axial.pressed(depth), rel=1e-12)
    carried = sum(-mount.axes[2] @ e.mounts[mount.name].force for mount in system.mounts.values())
    assert carried == pytest.approx(factor * mass * G, rel=1e-8)  # Newton's method ends at 1e-9 of the weight or less
    r = wr.simulate(system, wr.HalfSine(peak=1e-9, duration=0.011, direction="z"), duration=0.2, timestep=1e-4)
    # what an equilibrium's rounding and a shock of 1e-9 m/s^2 leave
    assert r.peaks.bodies[system.payloads[0]].acceleration.value < 1e-6
    assert all(r.peaks.contacts[name].from_start and not r.peaks.contacts[name].struck for name in pressed)


def test_a_block_on_its_stops_rings_and_answers_as_a_spring_and_a_damper():
    """Small motions about a rest on four stops and one spring: one mass on k and c, both by hand."""
    spring = wr.KelvinVoigt(k=1e4, c=30.0)
    isolators = {"wr12_400": wr.Isolator(name="spring", axial=spring, shear=spring, roll=spring)}
    system = heavy("shock_table.xml", 1.0, isolators)
    stop = system.mounts["s1"].isolator.axial
    depth = -wr.equilibrium(system).mounts["s1"].deflection[2] - stop.gap_below
    t = depth / stop.rounding
    assert 0.1 < t < 0.9  # where the rubber closes
    share = t * t * (3.0 - 2.0 * t)  # the slope of t^3 - t^4 / 2 by t
    k, c = spring.k + 4.0 * stop.k * share, spring.c + 4.0 * stop.c * share
    natural, ratio = np.sqrt(k / 50.0), c / (2.0 * np.sqrt(k * 50.0))
    found = wr.modes(system)
    bounce = found.descriptions.index("bounce z")
    # both end with the equilibrium, whose depth is known to some 1e-9
    assert found.frequencies[bounce] * 2.0 * np.pi == pytest.approx(natural, rel=1e-6)
    assert found.damping_ratio[bounce] == pytest.approx(ratio, rel=1e-6)
    omega = 2.0 * np.pi * 60.0
    orbit = wr.periodic_orbit(system, frequency=60.0, acceleration=1e-4, direction="z")
    expected = 1e-4 * abs((k + 1j * omega * c) / (k - 50.0 * omega**2 + 1j * omega * c))
    acceleration = orbit.response.bodies["block"].acceleration[:, 2]
    # 1e-4 m/s^2 at 60 Hz are 0.7 nm, of which the tangent sees its square; RK4 in 400 steps a period 1e-8
    assert np.ptp(acceleration) / 2.0 == pytest.approx(expected, rel=1e-4)
