"""What holds for every base motion, whatever its shape."""

import math
import pickle
from pathlib import Path

import numpy as np
import pytest

from wirerope_mj.foundation.errors import ModelError, RecordError
from wirerope_mj.motions import (
    DecayingSine,
    DoubleHalfSine,
    DoubleTriangle,
    HalfSine,
    RandomVibration,
    Sawtooth,
    Scaled,
    ShockTableImpact,
    Sine,
    StruckPlate,
    SumOfMotions,
    Sweep,
    Trapezoid,
    Turned,
    VelocityStep,
    VibrationLines,
    load_record,
    motion_from_dict,
)
from wirerope_mj.motions.motion import unique_times

pytestmark = pytest.mark.quick

DATA = Path(__file__).parents[1] / "data"
G = 9.80665

MOTIONS = {
    "half-sine": HalfSine(peak=15 * G, duration=0.011, direction="z"),
    "late half-sine": HalfSine(peak=-15 * G, duration=0.011, direction=(1.0, 2.0, -0.5), start=0.1),
    "sawtooth": Sawtooth(peak=20 * G, duration=0.011, direction="x", start=0.02),
    "trapezoid": Trapezoid(peak=50.0, duration=0.01, rise=0.001, direction="y", start=1 / 3),
    "rectangle": Trapezoid(peak=50.0, duration=0.01, rise=0.0, direction="y", start=0.07),
    "triangle": Trapezoid(peak=50.0, duration=0.01, rise=0.005, direction="y"),
    "velocity step": VelocityStep(velocity=2.0, direction="z", start=0.01),
    "sine": Sine(frequency=7.0, acceleration=3.0, direction="z"),
    "ending sine": Sine(frequency=7.0, acceleration=3.0, direction="z", duration=0.31),
    "slow sweep": Sweep(start=5.0, stop=5.2, rate=1.0, acceleration=2.0, direction="x"),
    "fast sweep up": Sweep(start=0.3, stop=4.0, rate=60.0, acceleration=2.0, direction="x"),
    "fast sweep down": Sweep(start=8.0, stop=0.2, rate=150.0, acceleration=2.0, direction="x"),
    "double half-sine": DoubleHalfSine(peak=600.0, velocity=2.25, displacement=0.0525, direction="z", start=0.03),
    "double triangle": DoubleTriangle(peak=-600.0, velocity=-2.25, displacement=-0.0525, direction=(1, 0, 2), r2=0.6),
    "double triangle that begins with a jump": DoubleTriangle(
        peak=600.0, velocity=2.25, displacement=0.0525, direction="x", r1=0.0, r2=1.0, start=0.1
    ),
    "table that stops at once": ShockTableImpact(drop_height=0.5, rebound=0.3, start=0.02),
    "table on a programmer": ShockTableImpact(drop_height=0.5, rebound=0.3, pulse_duration=0.008, direction="x"),
    "table that falls first": ShockTableImpact(drop_height=0.1, rebound=0.3, pulse_duration=0.02, fall=True, start=0.05),
    "struck plate": StruckPlate(pressure=20e3, decay=0.9e-3, areal_mass=320.0, direction="z", start=0.01),
    "light plate": StruckPlate(pressure=-40e3, decay=0.5e-3, areal_mass=0.5e-3 * 1537500.0, direction=(1, 0, 1)),
    "struck deck": DecayingSine(frequency=14.0, damping=0.05, velocity=-2.0, direction="z", start=0.1),
    "deck under a blow": DecayingSine(frequency=8.0, damping=0.1, acceleration=90.0, direction="y", impact_duration=0.02),
    "endless lines": VibrationLines(velocity=[(5.0, 0.01), (12.0, 0.004)], direction="z", phases=[0.3, -1.0]),
    "endless lines that rise": VibrationLines(acceleration=[(6.0, 1.0), (7.0, 2.0)], direction="z", seed=3, rise=0.4),
    "lines of a while": VibrationLines(displacement=[(8.0, 1e-3)], direction=(1, 1, 0), duration=1.1, fall=0.2, start=0.2),
    "random": RandomVibration(psd=[(5.0, 1.0), (20.0, 3.0), (40.0, 0.5)], duration=2.0, seed=7, direction="x", start=0.1),
    "record": load_record(DATA / "deck_shock.csv", channels={"ax": "x", "ch3": (0.0, 1.0, 1.0)}, start=0.3),
}
MOTIONS["sum"] = MOTIONS["half-sine"] + MOTIONS["sawtooth"] + MOTIONS["velocity step"] + MOTIONS["record"]
MOTIONS["scaled sum"] = Scaled(MOTIONS["sum"], -1.7)
MOTIONS["turned sum"] = Turned(MOTIONS["scaled sum"], rotation=[[0.0, -0.8, 0.6], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
MOTIONS["turned to a line"] = Turned(MOTIONS["late half-sine"], direction=(0.0, 1.0, 2.0))

every_motion = pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS.keys())


def grid(motion, intervals=400):
    """Instants from before the motion to after it, with all corners among them."""
    end = motion.end if math.isfinite(motion.end) else 1.0
    return unique_times(np.concatenate([np.linspace(-0.013, 1.2 * end + 0.017, intervals), motion.corners]))


def integral(function, time):
    """Gauss-Legendre with 10 nodes per interval, shape (n_t - 1, 3)."""
    nodes, weights = np.polynomial.legendre.leggauss(10)
    half = np.diff(time) / 2
    points = (time[:-1] + time[1:])[:, None] / 2 + half[:, None] * nodes
    values = function(points.ravel()).reshape(*points.shape, 3)
    return half[:, None] * np.einsum("ijk,j->ik", values, weights)


@every_motion
def test_velocity_is_the_integral_of_acceleration_plus_the_jumps(motion):
    time = grid(motion)
    velocity = motion.velocity(time)
    change = integral(motion.acceleration, time)
    for when, jump in motion.velocity_jumps:
        change[np.searchsorted(time, when) - 1] += jump
    # The rule is exact to roundoff on these intervals (at most 0.6 rad at 10 nodes); 1e-12 leaves room for the phase
    # error of a sweep, which is its phase in radians times 1e-16.
    assert np.abs(np.diff(velocity, axis=0) - change).max() < 1e-12 * np.abs(velocity).max()


@every_motion
def test_displacement_is_the_integral_of_velocity(motion):
    time = grid(motion)
    displacement = motion.displacement(time)
    error = np.diff(displacement, axis=0) - integral(motion.velocity, time)
    assert np.abs(error).max() < 1e-12 * np.abs(displacement).max()


@every_motion
def test_between_corners_acceleration_is_smooth_on_the_shortest_time_scale(motion):
    # Two neighbouring instants, 1e-6 of the time scale apart, differ by about 2 pi 1e-6 of the peak unless a corner
    # lies between them; a corner that `corners` does not name would differ by far more.
    time = grid(motion, 3000)
    step = 1e-6 * min(motion.shortest_time, 1.0)
    left = time[np.searchsorted(motion.corners, time, side="right") == np.searchsorted(motion.corners, time + step)]
    jump = np.abs(motion.acceleration(left + step) - motion.acceleration(left)).max()
    assert jump <= 1e-4 * np.abs(motion.acceleration(time)).max()


@every_motion
def test_values_at_a_corner_are_those_just_after_it(motion):
    corners = motion.corners
    # Within 1e-10 s nothing but a jump can change by more than 1e-10 s times the steepest slope, below 1e6 m/s^3 here.
    np.testing.assert_allclose(motion.acceleration(corners), motion.acceleration(corners + 1e-10), rtol=0, atol=1e-4)
    np.testing.assert_allclose(motion.velocity(corners), motion.velocity(corners + 1e-10), rtol=0, atol=1e-7)
    np.testing.assert_allclose(motion.displacement(corners), motion.displacement(corners - 1e-10), rtol=0, atol=1e-8)


@every_motion
def test_values_have_one_row_per_time_and_three_columns(motion):
    for function in (motion.acceleration, motion.velocity, motion.displacement):
        assert function(0.005).shape == (1, 3)
        assert function([0.0, 0.005]).shape == (2, 3)
        assert function(np.array([])).shape == (0, 3)
    with pytest.raises(ValueError, match=r"`time` must be a number or one-dimensional, got shape \(2, 2\)"):
        motion.acceleration(np.zeros((2, 2)))


@every_motion
def test_stored_parameters_rebuild_the_motion_bit_for_bit(motion):
    rebuilt = motion_from_dict(motion.to_dict())
    time = grid(motion)
    assert rebuilt.acceleration(time).tobytes() == motion.acceleration(time).tobytes()
    assert rebuilt.velocity(time).tobytes() == motion.velocity(time).tobytes()
    assert rebuilt.displacement(time).tobytes() == motion.displacement(time).tobytes()
    assert rebuilt.description == motion.description
    assert rebuilt.events == motion.events


@every_motion
def test_stored_parameters_are_values_that_toml_knows(motion):
    def check(value):
        if isinstance(value, dict):
            assert all(type(key) is str for key in value)
            value = list(value.values())
        if isinstance(value, list):
            for item in value:
                check(item)
        else:
            assert type(value) in (str, float, int, bool)

    check(motion.to_dict())


@every_motion
def test_a_motion_survives_pickling(motion):
    time = grid(motion)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(motion)).velocity(time), motion.velocity(time))


@every_motion
def test_events_are_in_order_of_time(motion):
    times = [time for time, _ in motion.events]
    assert times
    assert times == sorted(times)


def test_numbers_of_numpy_are_stored_as_plain_floats():
    motion = HalfSine(peak=np.float32(2.0), duration=np.float64(0.01), direction=np.array([0, 1, 1]), start=1)
    assert motion.to_dict() == {
        "kind": "half-sine", "peak": 2.0, "duration": 0.01, "direction": [0.0, 1.0, 1.0], "start": 1.0,
    }  # fmt: skip
    assert all(type(motion.to_dict()[name]) is float for name in ("peak", "duration", "start"))


def test_motions_add():
    a, b, c = MOTIONS["half-sine"], MOTIONS["late half-sine"], MOTIONS["sine"]
    total = a + (b + c)
    assert total.terms == (a, b, c)
    time = grid(b)
    expected = a.acceleration(time) + b.acceleration(time) + c.acceleration(time)
    np.testing.assert_allclose(total.acceleration(time), expected, rtol=1e-15, atol=1e-13)
    assert (a + b).duration == (a + b).end == b.end == 0.1 + 0.011
    assert total.duration == math.inf
    assert total.shortest_time == 0.011
    np.testing.assert_array_equal((a + b).corners, [0.0, 0.011, 0.1, 0.111])
    assert total.description == f"{a.description} + {b.description} + {c.description}"
    with pytest.raises(TypeError, match="unsupported operand"):
        a + 1.0
    with pytest.raises(ValueError, match="`terms` must hold at least one motion"):
        SumOfMotions(terms=())


def test_corners_at_the_same_instant_are_one():
    a = HalfSine(peak=1.0, duration=0.3, direction="x")
    b = HalfSine(peak=1.0, duration=0.1, direction="y", start=0.2)  # 0.1 + 0.2 is not 0.3 in floating point
    np.testing.assert_array_equal((a + b).corners, [0.0, 0.2, 0.3])


def test_velocity_jumps_at_the_same_instant_add():
    total = VelocityStep(velocity=2.0, direction="z") + VelocityStep(velocity=-1.0, direction="x")
    ((time, jump),) = (total + HalfSine(peak=1.0, duration=0.1, direction="y")).velocity_jumps
    assert time == 0.0
    np.testing.assert_array_equal(jump, [-1.0, 0.0, 2.0])
    later = total + VelocityStep(velocity=1.0, direction="z", start=1.0)
    assert [time for time, _ in later.velocity_jumps] == [0.0, 1.0]


def test_an_oblique_direction_is_normalised():
    motion = HalfSine(peak=10.0, duration=0.01, direction=(0.0, 3.0, -4.0))
    np.testing.assert_allclose(motion.acceleration(0.005), [[0.0, 6.0, -8.0]], rtol=1e-15)
    tiny = HalfSine(peak=10.0, duration=0.01, direction=(0.0, 0.0, 1e-200))
    np.testing.assert_array_equal(tiny.acceleration(0.005), [[0.0, 0.0, 10.0]])


@pytest.mark.parametrize(
    ("direction", "message"),
    [
        ("w", 'must be "x", "y", "z" or a 3-vector, got \'w\''),
        ((1.0, 0.0), r'must be "x", "y", "z" or a 3-vector, got \(1.0, 0.0\)'),
        (None, 'must be "x", "y", "z" or a 3-vector, got None'),
        ((0.0, 0.0, 0.0), r"must be finite and not zero, got \[0.0, 0.0, 0.0\]"),
        ((0.0, math.nan, 1.0), r"must be finite and not zero, got \[0.0, nan, 1.0\]"),
    ],
)
def test_a_direction_that_is_none_is_refused(direction, message):
    with pytest.raises(ValueError, match="`direction` " + message):
        HalfSine(peak=1.0, duration=0.01, direction=direction)


def test_stored_parameters_that_are_wrong_are_named():
    good = MOTIONS["half-sine"].to_dict()
    with pytest.raises(ModelError, match="Unknown kind of motion 'cosine'; known kinds: half-sine,"):
        motion_from_dict({**good, "kind": "cosine"})
    with pytest.raises(ModelError, match="'half-sine': unknown pek; its parameters are peak, duration, direction, start"):
        motion_from_dict({**good, "pek": 1.0})
    with pytest.raises(ModelError, match="'half-sine': missing peak, direction; its parameters are"):
        motion_from_dict({"kind": "half-sine", "duration": 0.01})
    with pytest.raises(ModelError, match="'sum': missing terms"):
        motion_from_dict({"kind": "sum"})
    with pytest.raises(RecordError, match="gone.csv: no such file"):
        motion_from_dict({"kind": "record", "path": "gone.csv"})
