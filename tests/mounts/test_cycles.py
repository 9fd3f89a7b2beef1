"""Long records cut into steady loops: cycles, amplitudes and operating points found beside noise and drift."""

import re

import numpy as np
import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.mounts.identification.measured import prepare
from wirerope_mj.mounts.test_rig import cyclic_test, load_cycles, measured, steady_loops
from wirerope_mj.mounts.test_rig.passive import is_level
from wirerope_mj.mounts.test_rig.turning import find_turning_points, rms_noise

pytestmark = pytest.mark.quick

LAW = wr.AsymmetricBoucWen.from_normalised(z_max=700.0, x_y=1e-3, sigma=0.6, n=1.0, k1=5e4, k2=1e6, k3=2e8, b=np.e, c=35.0)
AMPLITUDES = np.array([0.5e-3, 1.5e-3, 4e-3, 10e-3])


def errors(loops, law, operating_point=0.0):
    """Return of every loop: its error over half the force range, without the mean, and the relative error of its area."""
    result = []
    for loop in loops:
        exact = cyclic_test(law, loop.amplitude, operating_point=operating_point)[0]
        force = np.empty_like(loop.force)
        for rising in (True, False):
            path, branch = exact.branch(rising=rising)
            direction = 1.0 if rising else -1.0
            bottom, top = int(np.argmin(loop.deflection)), int(np.argmax(loop.deflection))
            index = np.arange(loop.deflection.size)
            between = (index >= bottom) & (index <= top) if bottom < top else (index >= bottom) | (index <= top)
            mask = between if rising else ~between
            force[mask] = np.interp(direction * loop.deflection[mask], direction * path, branch)
        half = 0.5 * np.ptp(exact.force)
        result.append((np.std(loop.force - force) / half, loop.dissipated_energy / exact.dissipated_energy - 1.0))
    return np.array(result)


@pytest.mark.parametrize(
    ("record", "most"),
    [
        # Noise of 1 % averaged over three cycles, 0.6 %, and the line through turning points of a twentieth of it.
        ({}, 0.008),
        ({"drift": 300.0, "zero": -80.0}, 0.008),  # 300 N is half of the smallest loops' force range
        ({"points": 201.37, "drift": -300.0}, 0.008),  # no whole number of samples in a cycle
        ({"points": 1999.3}, 0.008),
        ({"operating_point": -3e-3, "drift": 100.0}, 0.01),  # the smallest still remembers the ramp
        ({"cycles": 2, "drift": 100.0}, 0.014),  # one full cycle from turning point to turning point: no mean
        # Noise of the deflection times the tangent stiffness: 10 um x 700 N/mm on 300 N of the smallest loop.
        ({"slack": 1e-3, "drift": 100.0}, 0.03),
    ],
)
def test_every_amplitude_of_a_long_record_comes_back_as_its_steady_loop(record, most):
    time, deflection, force = rig_record(LAW, AMPLITUDES, **record)
    loops = steady_loops(deflection, force, time=time)
    point = record.get("operating_point", 0.0)
    assert len(loops) == 4
    # 3 standard deviations of the deflection's noise, averaged over three cycles.
    np.testing.assert_allclose([loop.amplitude for loop in loops], AMPLITUDES, rtol=1e-3, atol=2e-5 * ("slack" in record))
    np.testing.assert_allclose([loop.operating_point for loop in loops], point, atol=1e-6 + 2e-5 * ("slack" in record))
    assert {loop.cycles for loop in loops} == {record.get("cycles", 5) - 1}
    assert all(loop.deflection.size == 201 and loop.deflection[0] == loop.deflection[-1] for loop in loops)
    error, area = errors(loops, LAW, point).T
    assert (error < most).all(), error
    # The area of the two larger loops is a quarter of their force range times their stroke: 1 % of force is 1 % of it.
    assert (np.abs(area[2:]) < 0.01).all(), area


@pytest.mark.quick
@pytest.mark.parametrize("points", [23.7, 37.3, 61.9])
def test_few_samples_of_a_cycle_make_no_drift(points, monkeypatch):
    """Of a steady device with a constant offset: what is taken out over the whole record, of half of the force range."""
    from wirerope_mj.mounts.test_rig import cycles

    time, deflection, force = rig_record(LAW, [3e-3, 8e-3], points=4000.0, zero=12.0, noise=0.0)
    taken, drift = [], cycles._drift
    monkeypatch.setattr(cycles, "_drift", lambda *given: taken.append(drift(*given)) or taken[-1])
    for late in (0.0, 0.3, 0.7):
        even = np.arange(late / points, time[-1] - 0.1, 1.0 / points)
        steady_loops(np.interp(even, time, deflection), np.interp(even, time, force), time=even)
    assert len(taken) == 6
    assert np.abs(taken).max() * time[-1] < 0.005 * 0.5 * np.ptp(force)


def test_drift_of_the_zero_changes_nothing_but_the_mean():
    plain, drifting = (
        steady_loops(*record[1:], time=record[0])
        for record in (rig_record(LAW, AMPLITUDES, drift=drift) for drift in (0.0, 500.0))
    )
    for one, other in zip(plain, drifting, strict=True):
        # A line is taken out as exactly as it is put in, but for the smoothing at a record's last sample.
        np.testing.assert_allclose(other.force - other.force.mean(), one.force - one.force.mean(), atol=1e-6 * 500.0)


def test_time_matters_where_the_sampling_is_not_uniform():
    time, deflection, force = rig_record(LAW, [4e-3], cycles=6, points=1000.0, noise=0.0, drift=200.0)
    kept = np.random.default_rng(3).random(time.size) < 0.25
    (loop,) = steady_loops(deflection[kept], force[kept], time=time[kept])
    error, area = errors([loop], LAW)[0]
    assert error < 2e-3  # 80 bins of three samples each are not in the middle of what they stand for
    assert abs(area) < 5e-3


@pytest.mark.parametrize(
    ("phases", "levels"),
    [
        ([0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0]),
        ([0.0, 0.1, 0.6, 1.0], [0.0, 1.0, -1.0, 0.0]),  # up faster than down, and cut short at the record's end
        ([0.0, 0.2, 0.3, 0.7, 0.8, 1.0], [0.0, 1.0, 1.0, -1.0, -1.0, 0.0]),  # held at the turning points
    ],
)
def test_waves_of_any_shape_are_cut_and_averaged(phases, levels):
    shape = np.interp(np.arange(200) / 200, phases, levels)
    path = np.concatenate([np.tile(size * shape, 4) for size in AMPLITUDES])
    noise = 1e-5 * np.random.default_rng(2).standard_normal(path.size)
    loops = steady_loops(path + noise, LAW.trace(path).force)
    # A hold turns noise to both sides into amplitude: three standard deviations of it, averaged over three cycles.
    assert [loop.amplitude for loop in loops] == pytest.approx(AMPLITUDES, abs=2e-5)
    # Noise of the deflection as it weighs in the smallest loop; a cycle cut at a wrong phase leaves 1.6 % in the largest.
    assert (errors(loops, LAW)[:, 0] < [0.03, 0.02, 0.01, 0.006]).all()


@pytest.mark.parametrize("points", [199.3, 500.0, 53.0])
def test_turning_points_of_a_triangle_are_not_cut_off(points):
    corners = np.concatenate([size * np.array([0.0, 1.0, -1.0, 0.0] * 5) for size in AMPLITUDES])
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(corners)) / np.repeat(AMPLITUDES, 20)[1:])]) / 4.0
    fine = np.union1d(way, np.linspace(0.0, way[-1], 40_000))  # the device turns at the corners, wherever samples stand
    path = np.interp(fine, way, corners)
    at = np.arange(0.0, way[-1], 1.0 / points)
    loops = steady_loops(np.interp(at, fine, path), np.interp(at, fine, LAW.trace(path).force), time=at)
    # Means over a two-hundredth of the cycle would lose 1/200 of the amplitude and 1 % of the energy; three samples on
    # either side give the turning point to 2e-4. Chords between 53 samples lose another 0.2 % of the area.
    np.testing.assert_allclose([loop.amplitude for loop in loops], AMPLITUDES, rtol=3e-4)
    error, area = errors(loops, LAW).T
    assert (error < 2e-3).all(), error
    assert (np.abs(area) < 4e-3).all(), area


def test_steps_of_a_converter_are_no_saturation():
    time, deflection, force = rig_record(LAW, AMPLITUDES, noise=0.0)
    loops = steady_loops(np.round(deflection / 1e-5) * 1e-5, np.round(force / 10.0) * 10.0, time=time)
    assert (errors(loops, LAW)[:, 0] < [0.02, 0.01, 0.006, 0.004]).all()  # 10 N are 3, 1.5, 1, 0.6 % of half their ranges
    assert len(prepare(loops)) == 4


def test_two_operating_points_of_one_record_are_two_loops():
    first = rig_record(LAW, [2e-3], operating_point=-4e-3, seed=1)
    second = rig_record(LAW, [2e-3], operating_point=3e-3, seed=2)
    loops = steady_loops(*(np.concatenate([a, b]) for a, b in zip(first[1:], second[1:], strict=True)))
    assert [loop.operating_point for loop in loops] == pytest.approx([-4e-3, 3e-3], abs=1e-6)


def test_one_cycle_stays_what_it_is():
    (loop,) = measured(cyclic_test(LAW, 4e-3), points_per_cycle=100, force_noise=5.0, seed=4)
    for cut in (slice(None), slice(None, -1)):  # with the sample that repeats the first, and without
        (again,) = steady_loops(loop.deflection[cut], loop.force[cut])
        assert again.cycles == 1
        np.testing.assert_allclose(again.deflection, loop.deflection, atol=1e-12)
        np.testing.assert_allclose(again.force[1:-1], loop.force[1:-1], rtol=1e-12)


def test_noise_is_told_from_motion():
    rng = np.random.default_rng(1)
    path = np.sin(2.0 * np.pi * np.arange(2000) / 50)
    assert rms_noise(path) < 1e-4  # fourth differences of a sine of 50 samples: (2 pi / 50)^4 / sqrt(70)
    noisy = path + 0.05 * rng.standard_normal(path.size)
    assert rms_noise(noisy) == pytest.approx(0.05, rel=0.1)  # the median of 2000 correlated numbers
    trace = find_turning_points(noisy, np.arange(2000.0))
    assert trace.turns.size == 82  # two in each of 40 cycles, and both ends
    # A quarter of a period after a zero; crossings at 0.7 of the amplitude, with a slope of 0.09 a sample, are sharp to
    # 0.05 / sqrt(3) / 0.09 = 0.3 samples, the mean of two to 0.23; noise may cross again a sample further out.
    np.testing.assert_allclose(trace.times[1:-1], 12.5 + 25.0 * np.arange(80), atol=4 * 0.23 + 0.5)


def test_file_of_records_is_read_with_its_units_and_in_its_order(tmp_path):
    rows = []
    for number, size in enumerate((4e-3, 1.5e-3), start=1):
        time, deflection, force = rig_record(LAW, [size], seed=number)
        rows += [f"{number};{t:.5f};{1e3 * x:.7g};{f / 1e3:.7g}" for t, x, f in zip(time, deflection, force, strict=True)]
    path = tmp_path / "t.csv"
    path.write_text("\n".join(["loop;time [s];deflection [mm];force [kN]", *rows]), encoding="utf-8")
    loops = load_cycles(path)
    assert [loop.amplitude for loop in loops] == pytest.approx([4e-3, 1.5e-3], rel=1e-3)
    assert (errors(loops, LAW)[:, 0] < 0.008).all()


def test_file_without_time_counts_as_uniform(tmp_path):
    _, deflection, force = rig_record(LAW, [4e-3])
    path = tmp_path / "t.csv"
    rows = [f"{x!r},{f!r}" for x, f in zip(deflection.tolist(), force.tolist(), strict=True)]
    path.write_text("\n".join(["deflection [m],force [N]", *rows]), encoding="utf-8")
    (one,), (other,) = load_cycles(path), steady_loops(deflection, force)
    np.testing.assert_array_equal(one.force, other.force)


def sine(*, cycles=3.0, points=100, lag=0.3, scale=1.0):
    """Return time, deflection and force of an ellipse."""
    angle = 2.0 * np.pi * np.arange(int(cycles * points) + 1) / points
    return angle, 1e-3 * scale * np.sin(angle), 1e3 * np.sin(angle + lag)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t, x, f: (t, 0 * x + 2e-3, f), r"lines 2 to 302: the deflection never changes, it stands at 2 mm"),
        (
            lambda t, x, f: (t, 1e-6 * np.random.default_rng(0).standard_normal(x.size), f),
            r"never changes by more than its noise, 0\.00\d+ mm",
        ),
        (lambda t, x, f: (t[:40], x[:40], f[:40]), r"lines 2 to 41: there is no full cycle.* by 1, 0.3626 mm"),
        (lambda t, x, f: (t[:9], x[:9], f[:9]), r"lines 2 to 10: 9 samples; one cycle needs at least 12"),
        (
            lambda t, x, f: (t, x, np.minimum(f, 800.0)),
            r"lines \d+ to \d+: \d+ samples stand at exactly the largest force, 800 N.*saturated",
        ),
        (lambda t, x, f: (t, x, np.maximum(f, -800.0)), r"exactly the smallest force, -800 N"),
        (lambda t, x, f: (t, x, -f), r"the force falls where the deflection grows; both are positive in tension"),
        (lambda t, x, f: (t, x[::-1], f[::-1]), r"the cycle gives \d.*J away"),
        (lambda t, x, f: (t, x, 1e6 * x - 0.02 * f), r"the cycle of \+-1 mm encloses no area: it gives .* lagging"),
        (lambda t, x, f: (t, x, 0 * f + 5.0), r"the force never changes, it stands at 5 N"),
    ],
)
def test_what_cannot_be_used_is_named_with_its_lines(tmp_path, change, message):
    path = write_record(tmp_path / "t.csv", *change(*sine()))
    with pytest.raises(RecordError) as caught:
        load_cycles(path)
    assert str(caught.value).startswith(f"{path}, lines ")
    assert re.search(message, str(caught.value)), caught.value


def test_force_cut_off_a_little_beside_noise_is_refused():
    time, deflection, force = rig_record(LAW, AMPLITUDES)
    cut = np.minimum(force, 0.97 * force.max())  # over 2 % of the stroke
    with pytest.raises(ValueError, match=r"samples stand at exactly the largest force.*saturated"):
        steady_loops(deflection, cut, time=time)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_force_cut_off_with_noise_behind_is_refused(side):
    straight = wr.BoucWen(alpha=300e3, beta=2.0, gamma=-0.5, n=1.5, k=80e3)
    time, deflection, force = rig_record(straight, AMPLITUDES)
    limit = 0.6 * np.abs(force).max()
    noise = 1e-3 * limit * np.random.default_rng(7).standard_normal(force.size)
    word = "largest" if side > 0 else "smallest"
    with pytest.raises(ValueError, match=rf"at its {word} deflection the force stays .* on the way there and back.*saturated"):
        steady_loops(deflection, side * np.minimum(side * force, limit) + noise, time=time)


def test_what_yields_is_level_and_not_cut_off():
    plastic = wr.EnhancedDryFriction(k=100.0, d=500.0, u_c=1e-4)  # five times u_c are level to 1 %
    loops = steady_loops(*rig_record(plastic, AMPLITUDES)[1:])
    assert all(is_level(loop) for loop in loops)
    assert not any(is_level(loop) for loop in steady_loops(*rig_record(LAW, AMPLITUDES)[1:]))


def test_stated_amplitudes_tell_when_units_are_mixed(tmp_path):
    time, deflection, force = rig_record(LAW, [4e-3])
    rows = [f"4,{x!r},{f!r}" for x, f in zip((1e3 * deflection).tolist(), force.tolist(), strict=True)]
    path = tmp_path / "t.csv"
    path.write_text("\n".join(["amplitude [mm],deflection [mm],force [N]", *rows]), encoding="utf-8")
    assert [loop.amplitude for loop in load_cycles(path)] == pytest.approx([4e-3], rel=1e-3)
    path.write_text("\n".join(["amplitude [mm],deflection [m],force [N]", *rows]), encoding="utf-8")
    with pytest.raises(RecordError, match=r"lines 2 to 1201: the amplitude is 4 mm but .* \+-4000 mm; do the two"):
        load_cycles(path)


@pytest.mark.parametrize("read", [load_cycles, wr.load_cyclic_test])
def test_millimetres_that_a_header_calls_metres_are_refused(tmp_path, read):
    (loop,) = measured(cyclic_test(LAW, 4e-3), seed=1)
    path = tmp_path / "t.csv"
    rows = [f"{x!r},{f!r}" for x, f in zip((1e3 * loop.deflection).tolist(), loop.force.tolist(), strict=True)]
    path.write_text("\n".join(["deflection [m],force [N]", *rows]), encoding="utf-8")
    with pytest.raises(RecordError, match=r"t\.csv, lines 2 to 202: an amplitude of 4 m is beyond any isolator.* in mm where"):
        read(path)
    with pytest.raises(ValueError, match=r"loop 1: an amplitude of 4 m is beyond any isolator"):
        prepare([wr.Loop.from_samples(1e3 * loop.deflection, loop.force)])


def test_too_few_samples_in_a_cycle_are_named():
    _, deflection, force = sine(cycles=8, points=10)
    with pytest.raises(ValueError, match=r"samples \d+ to \d+: the cycle has 1\d samples; it needs at least 12"):
        steady_loops(deflection, force)


def test_rows_that_are_missing_at_a_turning_point_are_named():
    time, deflection, force = sine()
    kept = (np.abs(time % (2.0 * np.pi) - 0.5 * np.pi) > 0.3) | (time < 2.0 * np.pi)
    with pytest.raises(ValueError, match=r"at a turning point of the cycle there are \d samples within .* rows missing"):
        steady_loops(deflection[kept], force[kept], time=time[kept])


def test_a_stroke_that_is_missing_is_named():
    time, deflection, force = sine()
    kept = np.gradient(deflection, time) > 0.0
    with pytest.raises(ValueError, match=r"3\.\d+ s of a cycle of 6\.\d+ s hold no samples: are rows missing there\?"):
        steady_loops(deflection[kept], force[kept], time=time[kept])


def test_series_that_are_no_record_are_refused():
    _, deflection, force = sine()
    with pytest.raises(ValueError, match="must be finite series of one length"):
        steady_loops(deflection, force[:-1])
    with pytest.raises(ValueError, match="must be finite series of one length"):
        steady_loops(np.where(deflection > 9e-4, np.nan, deflection), force)
    with pytest.raises(ValueError, match=r"without a value beyond 1e\+15"):
        steady_loops(deflection, np.where(np.arange(force.size) == 3, 1e300, force))
    with pytest.raises(ValueError, match="`time` must be finite, as long as `deflection`, and increase"):
        steady_loops(deflection, force, time=np.zeros(force.size))
