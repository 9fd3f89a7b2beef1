"""A long record stands in memory once: what is read, checked, integrated and stepped through needs little beside it."""

import tracemalloc

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.engine.simulation import grid as grid_module
from wirerope_mj.engine.simulation.grid import time_grid
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.motions.piecewise import PiecewiseLinear

SAMPLES = 300_000  # 30 s at 10 kHz
HELD = 32  # bytes a sample: its instant and three axes
BESIDE = 24  # bytes a sample: the copies that checks make of one axis at a time, given back before the next
FIXED = 12e6  # bytes whatever the length: blocks of the file's text, of the grid and of the integrals


@pytest.fixture(scope="module")
def ride(tmp_path_factory):
    """A ride on three axes that begins and ends at rest."""
    path = tmp_path_factory.mktemp("ride") / "ride.csv"
    rng, time = np.random.default_rng(4), np.arange(SAMPLES) / 10_000.0
    values = 20.0 * np.sin(2 * np.pi * rng.uniform(5.0, 50.0, 3) * time[:, None]) * np.sin(np.pi * time / time[-1])[:, None]
    with path.open("w") as file:
        file.write("time [s],x [m/s^2],y [m/s^2],z [m/s^2]\n")
        np.savetxt(file, np.column_stack([time, values]), fmt="%.4f,%.5g,%.5g,%.5g")
    return path


def peak_of(action):
    """Return what an action returns, and the peak of what it allocated [bytes]."""
    tracemalloc.start()
    try:
        result = action()
        return result, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_reading_holds_a_record_once(ride):
    record, peak = peak_of(lambda: wr.load_record(ride, baseline="velocity"))
    assert record.time.size == SAMPLES
    # where lines end with two characters, twice as much is asked for, but never touched: no part of this file
    assert peak < (HELD + BESIDE) * SAMPLES + FIXED


def test_integrals_and_grid_of_a_record_need_no_memory_that_grows_with_it(ride):
    record = wr.load_record(ride, baseline="velocity")

    def walk():
        record.displacement([0.1, 29.0])
        grid = time_grid(start=0.0, duration=30.0, sample_rate=1000.0, timestep=1e-3, motion=record)
        return sum(block.steps.sum() for block in grid.blocks())

    steps, peak = peak_of(walk)
    assert steps >= SAMPLES - 1
    assert peak < 8 * SAMPLES + FIXED  # eight times less than the integrals and the grid of all samples at once would be


def test_the_grid_of_blocks_is_the_grid_as_a_whole(monkeypatch):
    class Corners:
        velocity_jumps = ()
        corners = np.unique(np.concatenate([np.arange(6000) / 1e3 + s for s in (0.0, 5e-11, 1.6e-10, 2.4e-10)]))

    def pieces(block):
        monkeypatch.setattr(grid_module, "BLOCK", block)
        grid = time_grid(start=0.3337, duration=5.1234567, sample_rate=1000.0, timestep=3e-4, motion=Corners())
        blocks = list(grid.blocks())
        return len(blocks), [np.concatenate(part) for part in zip(*(vars(b).values() for b in blocks), strict=True)]

    count, whole = pieces(1 << 30)
    assert count == 1
    for block in (1, 7, 1000):
        count, parts = pieces(block)
        assert count > 5
        for a, b in zip(whole, parts, strict=True):
            np.testing.assert_array_equal(a, b)


def test_integrals_are_continuous_where_blocks_of_knots_meet():
    rng, knots = np.random.default_rng(5), np.arange(10_000) * 1e-3
    values = rng.standard_normal((knots.size, 3))
    line = PiecewiseLinear(knots, values)
    velocity = np.concatenate([np.zeros((1, 3)), np.cumsum((values[1:] + values[:-1]) * 5e-4, axis=0)])
    np.testing.assert_allclose(line.derivative(knots, 1), velocity, atol=1e-12)  # rounding of ten thousand sums
    gains = velocity[:-1] * 1e-3 + (2 * values[:-1] + values[1:]) * 1e-6 / 6
    displacement = np.concatenate([np.zeros((1, 3)), np.cumsum(gains, axis=0)])
    np.testing.assert_allclose(line.derivative(knots, 0), displacement, atol=1e-12)
    scattered = rng.permutation(knots)
    np.testing.assert_array_equal(line.derivative(scattered, 1)[np.argsort(scattered)], line.derivative(knots, 1))


def test_the_error_of_a_densely_sampled_record_is_estimated_and_not_taken_for_none(ride):
    system = wr.load_system(models_folder() / "shock_table.xml")
    record = wr.load_record(ride, baseline="velocity", start=-10.0)
    response = wr.simulate(system, record, duration=0.3)
    assert response.timestep == pytest.approx(1e-4, rel=1e-6)  # the record's own interval, below the samples' 1 ms
    assert 1e-9 < response.estimated_error < 1e-4
    finer = wr.simulate(system, record, duration=0.3, timestep=2.5e-5)
    peak, exact = (r.peaks.bodies["block"].acceleration.value for r in (response, finer))
    # the estimate is of the largest error of all quantities: the peak of one of them may be better, not much worse
    assert abs(peak - exact) < 3.0 * response.estimated_error * exact


def test_the_samples_of_a_long_run_are_read_and_recorded_block_by_block(tmp_path, monkeypatch):
    from wirerope_mj.views.recording.record import read_state

    # 301 samples: five blocks, the last of them short
    monkeypatch.setattr("wirerope_mj.engine.response.histories.BLOCK_ROWS", 70)
    system = wr.load_system(models_folder() / "shock_table.xml")
    memory = wr.simulate(system, wr.HalfSine(peak=50.0, duration=0.011, direction="z"), duration=0.3, timestep=1e-3)
    memory.save(tmp_path)
    loaded = wr.load_response(tmp_path)
    wr.record_rerun(loaded, tmp_path / "file.rrd", state=True)
    wr.record_rerun(memory, tmp_path / "memory.rrd", state=True)
    for name in ("file.rrd", "memory.rrd"):
        state = read_state(tmp_path / name)
        assert list(state) == memory.samples.names
        table = np.column_stack(list(state.values()))
        np.testing.assert_array_equal(table, memory.samples.columns(0, len(memory.samples.names)))
    assert loaded.time.size == 301
    np.testing.assert_array_equal(loaded.bodies["block"].position, memory.bodies["block"].position)
