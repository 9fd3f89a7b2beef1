"""Stepped sines against closed forms of linear mounts, and when a system counts as settled."""

import numpy as np
import pytest
from house import deck, mjcf, sdof
from shaken_mass import LEVEL, MASS, MOUNT, linear, transmitted, up

import wirerope_mj as wr
from wirerope_mj.dynamics.sweep.cycles import distance_to_limit


@pytest.fixture(scope="module")
def system():
    return sdof(linear(), mass=MASS)


THREE = {"x": (6.0, 0.3), "y": (9.0, 0.15), "z": (14.0, 0.25)}


@pytest.fixture(scope="module")
def three():
    """Return a mass that is held by one mount along three axes of different stiffness."""
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    world = deck({"b": 'pos="0 0 .2"'}) + (
        f'<body name="mass" pos="0 0 .3">{slides}<geom size=".1" mass="{MASS}"/><site name="p" pos="0 0 -.1"/></body>'
    )
    laws = {axis: linear(*THREE[axis]) for axis in THREE}
    isolator = wr.Isolator(name="a", roll=laws["x"], shear=laws["y"], axial=laws["z"])
    return wr.load_system(mjcf(world, [("m1", "p", "b", "a")], gravity=wr.STANDARD_GRAVITY), isolators={"a": isolator})


@pytest.mark.slow
@pytest.mark.parametrize("axis", THREE)
def test_steady_sines_are_the_closed_form_along_every_axis(three, axis):
    frequencies = THREE[axis][0] * np.array([0.5, 0.9, 1.0, 1.1, 1.5, 3.0])
    r = wr.stepped_sine(three, frequencies=frequencies, acceleration=LEVEL, direction=axis, payload="mass")
    assert r.settled.all()
    assert np.all(r.remaining <= 1e-4)
    np.testing.assert_array_equal(r.frequency, frequencies)
    # 1e-4 of settling and of the step.
    np.testing.assert_allclose(r.base_amplitude, LEVEL, rtol=1e-4)
    np.testing.assert_allclose(r.amplitude, LEVEL * transmitted(frequencies, *THREE[axis]), rtol=3e-4)
    others = [i for i, other in enumerate("xyz") if other != axis]
    assert np.abs(r.envelopes["mass"].acceleration[:, others]).max() < 1e-9
    # Deflection of the steady sine: A / w^2 times the amplification of the relative motion, and the sag along z.
    ratio, damping = frequencies / THREE[axis][0], THREE[axis][1]
    relative = LEVEL / (2 * np.pi * THREE[axis][0]) ** 2 / np.hypot(1 - ratio**2, 2 * damping * ratio)
    place = "xyz".index(axis)
    sag = wr.STANDARD_GRAVITY / (2 * np.pi * THREE["z"][0]) ** 2 if axis == "z" else 0.0
    np.testing.assert_allclose(r.mounts["m1"].maximum[:, place], relative - sag, atol=3e-4 * relative.max())
    np.testing.assert_allclose(r.mounts["m1"].minimum[:, place], -relative - sag, atol=3e-4 * relative.max())


def test_an_oblique_base_shakes_all_axes_at_once(three):
    frequencies = np.array([5.0, 10.0])
    r = wr.stepped_sine(
        three,
        frequencies=frequencies,
        acceleration=3.0,
        direction=(1.0, 2.0, 2.0),
        payload="mass",
        response_direction="y",
    )
    np.testing.assert_allclose(r.base_amplitude, 3.0, rtol=1e-4)
    assert r.response_direction == "y"
    assert r.direction == (1.0, 2.0, 2.0)
    for i, (axis, share) in enumerate(zip("xyz", (1 / 3, 2 / 3, 2 / 3), strict=True)):
        wanted = share * transmitted(frequencies, *THREE[axis])
        np.testing.assert_allclose(r.envelopes["mass"].transmissibility[:, i], wanted, rtol=3e-4)
    np.testing.assert_array_equal(r.transmissibility, r.envelopes["mass"].transmissibility[:, 1])


@pytest.mark.parametrize(("quantity", "power"), [("acceleration", 0), ("velocity", 1), ("displacement", 2)])
def test_steady_sines_take_the_level_in_any_quantity(system, quantity, power):
    frequencies = np.array([6.0, 12.0])
    level = LEVEL / (2 * np.pi * 6.0) ** power
    r = wr.stepped_sine(system, frequencies=frequencies, direction="z", payload="mass", **{quantity: level})
    np.testing.assert_allclose(r.base_amplitude, LEVEL * (frequencies / 6.0) ** power, rtol=1e-4)
    np.testing.assert_allclose(r.transmissibility, transmitted(frequencies), rtol=3e-4)
    assert r.sweep is None


@pytest.mark.parametrize("decay", [1e-1, 1e-2, 1e-3, 1e-5])
def test_a_slow_approach_is_not_taken_for_a_steady_state(decay):
    cycles = np.arange(4000)
    amplitudes = (1.0 + 0.02 * np.exp(-decay * cycles))[:, np.newaxis]
    for n in (16, 40, 400, 4000):
        away = amplitudes[n - 1, 0] - 1.0
        found = distance_to_limit(amplitudes[:n])
        # Never below the truth, relative to an amplitude of 1.02 at most; rounding of 1e-16 is magnified by up to 1e6.
        assert 1.02 * found > away * (1 - 1e-6) - 1e-9
        assert found < 1.1 * 0.02 * np.exp(-decay * 0.75 * n) + 1e-9
    assert distance_to_limit(amplitudes[:15]) == np.inf
    # After 40 cycles the slowest changes by 2e-7 a cycle, and is 2 % away.
    assert np.ptp(amplitudes[39:41]) < (2.1e-7 if decay == 1e-5 else 1.0)


def test_steady_sines_are_the_reference_motions_of_a_bouc_wen_mass_without_a_spring():
    """References integrated from event to event at 1e-11: half range of the deflection and largest acceleration, z_max / M."""
    system = sdof(wr.BoucWen(alpha=1.0, beta=0.5, gamma=0.5, n=1.0), mass=1.0)
    omega, half_range, z_max = np.array(
        [[0.5, 0.45896197, 0.40265818], [0.8, 1.32292920, 0.83627730], [1.5, 0.23013706, 0.21640770]]
    ).T
    r = wr.stepped_sine(
        system,
        frequencies=omega / (2 * np.pi),
        acceleration=0.3,
        direction="z",
        payload="mass",
        timestep=0.02,
        settled=1e-6,
    )
    assert r.settled.all()
    deflection = r.mounts["m1"]
    # Where the mass rests in the end is free without a spring: the half range alone is determined. RK4 across the kinks at
    # 200 to 600 steps per cycle errs by 1e-5, as the step squared.
    np.testing.assert_allclose((deflection.maximum - deflection.minimum)[:, 2] / 2, half_range, rtol=3e-5)
    np.testing.assert_allclose(r.amplitude, z_max, rtol=3e-5)


def test_what_beats_or_changes_from_cycle_to_cycle_has_not_settled():
    cycles = np.arange(400)
    beats = 1.0 + 0.01 * np.cos(0.4 * cycles)
    alternating = 1.0 + 0.01 * (-1.0) ** cycles
    growing = 1.0 + 1e-4 * cycles
    for amplitudes in (beats, alternating, growing):
        assert distance_to_limit(amplitudes[:, np.newaxis]) > 5e-3
    small = np.column_stack([np.ones(400), 1e-9 * beats])  # what hardly moves is judged by what does
    assert distance_to_limit(small) < 1e-7


def test_what_does_not_settle_is_said(system):
    r = wr.stepped_sine(
        system,
        frequencies=[5.0, 19.0],
        acceleration=LEVEL,
        direction="z",
        payload="mass",
        settled=1e-9,
        largest_cycles=30,
    )
    np.testing.assert_array_equal(r.settled, [True, False])
    assert r.cycles[1] == 30
    (words,) = r.warnings
    assert words.startswith("not settled to 1e-09 after 30 cycles")
    assert "19 Hz" in words
    assert "5 Hz (" not in words
    again = wr.frequency_sweep(system, up(60.0), settled=1e-9, largest_cycles=16, timestep=1e-3, **MOUNT)
    assert "start frequency of 5 Hz" in again.warnings[0]
    assert not again.settled.any()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"frequencies": []}, "`frequencies` must be a series of numbers"),
        ({"frequencies": [5.0, -1.0]}, r"`frequencies\[1\]` must be > 0, got -1.0"),
        ({"payload": "rack"}, r"Payloads: \['mass'\]"),
        ({"velocity": 1.0}, "exactly one of .* must be given, got `acceleration` and `velocity`"),
        ({"acceleration": None}, "must be given, got none"),
        ({"direction": "w"}, '`direction` must be "x", "y", "z" or a 3-vector'),
        ({"response_direction": "w"}, "`response_direction` must be"),
        ({"direction": (0.0, 1.0, 1.0)}, "`direction` must lie along x, y or z"),
        ({"settled": -1.0}, "`settled` must be > 0"),
    ],
)
def test_bad_arguments_of_steady_sines_are_named(three, change, message):
    arguments = {"frequencies": [5.0], "acceleration": 1.0, "direction": "z", "payload": "mass"} | change
    with pytest.raises(ValueError, match=message):
        wr.stepped_sine(three, **arguments)
