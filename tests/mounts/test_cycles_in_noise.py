"""Noise of a cyclic test: it is named as the cause where it is one, and is never taken for a saturated load cell."""

import numpy as np
import pytest
from rig_records import write_record

import wirerope_mj as wr
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.test_rig import cyclic_test, load_cycles, measured, steady_loops
from wirerope_mj.mounts.test_rig.passive import force_noise

LAW = wr.load_isolator(catalogue_folder() / "enidine_wr16_400.toml").axial
POINTS = 200


def clean_record(amplitudes=(1e-3, 5e-3, 20e-3), cycles=3):
    """Return deflection [m] and force [N] of some cycles of each amplitude, one after the other."""
    sine = np.sin(2.0 * np.pi * np.arange(cycles * POINTS) / POINTS)
    path = np.concatenate([size * sine for size in amplitudes])
    return path, LAW.trace(path).force


def refusal(deflection, force):
    """Return why a record is refused; an empty text if it is not."""
    try:
        steady_loops(deflection, force)
    except ValueError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("noise", [0.01, 0.02, 0.05])
def test_noise_of_a_load_cell_is_not_taken_for_its_saturation(noise):
    """The noise is that of the load cell's range: a third of the force of the smallest loop at 5 %."""
    deflection, force = clean_record()
    noisy = [
        force + noise * 0.5 * np.ptp(force) * np.random.default_rng(seed).standard_normal(force.size) for seed in range(40)
    ]
    refusals = [message for message in (refusal(deflection, values) for values in noisy) if message]
    # The smallest loop may have lost its area.
    assert all("+-1 mm encloses no area beside its noise (noise of" in message for message in refusals)
    assert not refusals or noise > 0.01


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.02])
@pytest.mark.parametrize("level", [0.8, 0.9, 0.95, 0.98])
def test_a_clipped_force_is_refused_beside_noise(level, noise):
    deflection, force = clean_record([20e-3])
    for seed in range(5):
        noisy = force + noise * 0.5 * np.ptp(force) * np.random.default_rng(seed).standard_normal(force.size)
        with pytest.raises(ValueError, match=r"samples stand at exactly the largest force.*saturated"):
            steady_loops(deflection, np.minimum(noisy, level * force.max()))


def plain(rng):
    return rng.standard_normal(3 * POINTS)


NOTHING_BUT_NOISE = r"the force is noise of [\d.e+]+ N, ([89]\d[.\d]*|100) % of the force's rms value: it does not follow"


@pytest.mark.parametrize("seed", range(5))
def test_a_force_that_is_noise_is_called_noise_and_nothing_else(tmp_path, seed):
    deflection, _ = clean_record([5e-3])
    force = 1e3 * plain(np.random.default_rng(seed))
    time = np.arange(force.size) / POINTS
    with pytest.raises(RecordError, match=rf"lines \d+ to \d+: {NOTHING_BUT_NOISE}"):
        load_cycles(write_record(tmp_path / "t.csv", time, deflection, force))
    one = slice(0, POINTS + 1)
    for read in (load_cycles, wr.load_cyclic_test):
        with pytest.raises(RecordError, match=rf"lines 2 to 202: {NOTHING_BUT_NOISE}"):
            read(write_record(tmp_path / "t.csv", time[one], deflection[one], force[one]))


def test_noise_of_few_samples_is_called_noise_though_it_cannot_be_measured_well(tmp_path):
    """Sixty numbers tell their noise to a third of it; that one frequency has most of it has a chance of 1 in 10 000."""
    angle = 2.0 * np.pi * np.arange(61) / 60
    for seed in range(40):
        noise = 1e3 * np.random.default_rng(seed).standard_normal(61)
        path = write_record(tmp_path / "t.csv", angle, 5e-3 * np.sin(angle), noise)
        with pytest.raises(RecordError, match="the force is noise of"):
            wr.load_cyclic_test(path)


@pytest.mark.parametrize("read", [load_cycles, wr.load_cyclic_test])
@pytest.mark.parametrize("samples", [3 * POINTS, 5000])
def test_a_deflection_that_is_noise_is_called_noise(tmp_path, read, samples):
    """The range of 5000 numbers of noise is eight standard deviations and more."""
    for seed in range(5):
        deflection, force = np.random.default_rng(seed).standard_normal((2, samples)) * [[5e-3], [1e3]]
        path = write_record(tmp_path / "t.csv", np.arange(samples) / POINTS, deflection, force)
        with pytest.raises(RecordError, match=r"more than its noise, [\d.]+ mm, ([89]\d[.\d]*|100) % of its rms value"):
            read(path)


def test_noise_that_hides_the_sign_of_force_or_area_is_measured_and_named():
    deflection, force = clean_record([5e-3])
    refusals = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        noisy = [values + 0.2 * np.ptp(values) * rng.standard_normal(values.size) for values in (deflection, force)]
        refusals.append(refusal(*noisy))
    assert all("encloses no area beside its noise (noise of" in message for message in refusals if message)
    assert any(refusals)


def test_measured_noise_of_a_loop_is_that_of_its_samples():
    (loop,) = measured(cyclic_test(LAW, 5e-3), seed=3, force_noise=40.0)
    assert force_noise(loop) == pytest.approx(40.0, rel=0.2)  # the median of 200 correlated numbers
    deflection, force = clean_record([5e-3], cycles=8)
    noisy = force + 40.0 * np.random.default_rng(4).standard_normal(force.size)
    (loop,) = steady_loops(deflection, noisy)
    assert force_noise(loop) == pytest.approx(40.0 / np.sqrt(3.0), rel=0.2)  # the mean of three cycles


def test_cycles_that_differ_by_slow_noise_show_it():
    """Noise that neighbouring samples share is in none of their differences."""
    deflection, force = clean_record([5e-3], cycles=8)
    rng, box = np.random.default_rng(5), np.full(20, 0.05)
    slow = 2e3 * np.convolve(rng.standard_normal(force.size + 19), box, "valid")
    (loop,) = steady_loops(deflection, force + slow)
    assert loop.scatter > 3.0 * steady_loops(deflection, force)[0].scatter
    assert loop.scatter == pytest.approx(slow.std() / np.sqrt(3.0), rel=0.5)  # ten independent numbers a cycle
    with pytest.raises(ValueError, match="the force is noise of"):
        steady_loops(deflection, slow)
