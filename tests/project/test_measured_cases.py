"""The cases on measured data without the data: levels in any order, storeys recovered, folders that hold something else."""

import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from verification.building import CASES
from verification.building_bands import Errors, bands, channels, straight_on
from verification.building_data import LEVELS, read_motion, read_motions
from verification.building_fit import NAMES, START, bearings, springs, storeys_of
from verification.building_model import Storeys, building, predict
from verification.case import NotRunError
from verification.runner import NOT_RUN, run_case

INTERVAL = 0.01


def written(path, time, table, prediction, order):
    """Write a test as a file whose levels are numbered in an order."""
    columns = {"time_s": time, "table_acceleration": table}
    columns |= {f"a{i}": prediction.acceleration[:, level] for i, level in enumerate(order, start=1)}
    columns |= {f"d{i}": prediction.displacement[:, level] for i, level in enumerate(order, start=1)}
    pq.write_table(pa.table(columns), path)


@pytest.fixture(scope="module")
def truth():
    return Storeys(stiffness=np.array([1200.0, 900.0, 950.0, 1400.0, 870.0]), damping=np.array([30.0, 8, 12, 5, 20]))


@pytest.fixture(scope="module")
def folder(truth, tmp_path_factory):
    """Return a folder with two motions of a building whose levels are numbered upwards in one and downwards in the other."""
    root = tmp_path_factory.mktemp("measured")
    place = root / "base_isolated_building"
    place.mkdir()
    time = INTERVAL * np.arange(3000)
    table = 1.5 * np.sin(np.pi * time / time[-1]) ** 2 * np.random.default_rng(4).standard_normal(time.size)
    blank = np.zeros((time.size, LEVELS))
    pq.write_table(pa.table({"time_s": time}), place / "else.parquet")
    for name, order in (("ICA100", range(LEVELS)), ("LAC", reversed(range(LEVELS)))):
        nothing = type("Nothing", (), {"acceleration": blank, "displacement": blank})
        written(place / f"{name}.parquet", time, table, nothing, range(LEVELS))
        motion = read_motion(place / f"{name}.parquet")
        found = predict([building(bearings(np.zeros(len(NAMES))), truth)], motion)[0]
        written(place / f"{name}.parquet", time, table, found, list(order))
    (place / "else.parquet").unlink()
    return root


def test_levels_are_put_in_the_order_of_their_height(folder):
    motions = read_motions(folder)
    assert list(motions) == ["ICA100", "LAC"]
    np.testing.assert_array_equal(motions["ICA100"].displacement, motions["LAC"].displacement)
    assert (np.diff(np.abs(motions["LAC"].displacement).max(axis=0)) > 0.0).all()


def test_storeys_are_recovered_from_what_the_base_passes_on(folder, truth):
    found = storeys_of(read_motions(folder)["ICA100"])
    # The record ends while the building still moves, which the spectra take for a jump.
    np.testing.assert_allclose(found.stiffness, truth.stiffness, rtol=0.02)


def test_bearings_at_the_start_have_the_values_of_the_start():
    assert springs(np.zeros(len(NAMES))) == pytest.approx((START[4], -2.0 * START[6] * np.sqrt(START[4] * START[5]), START[5]))
    law = bearings(np.zeros(len(NAMES)))
    assert [one.softening for one in law.laws[:2]] == pytest.approx([START[8]] * 2)


def test_bands_hold_what_they_are_made_of_and_widen_beyond_the_fitted_amplitude(folder, truth):
    motion = read_motions(folder)["LAC"]
    numbers = np.zeros((2, len(NAMES)))
    predictions = predict([building(bearings(one), truth) for one in numbers], motion)
    peaks = np.abs(channels(motion)).max(axis=0)
    errors = Errors(members=numbers, frequency=np.array([0.1, 20.0]), discrepancy=np.zeros((2, 2 * LEVELS)), amplitude=1.0)
    np.testing.assert_allclose(bands(errors, predictions, motion), [peaks, peaks], rtol=1e-12)
    size = np.abs(motion.deflection).max()
    near = Errors(members=numbers, frequency=errors.frequency, discrepancy=errors.discrepancy, amplitude=0.6 * size)
    low, high = bands(near, predictions, motion)
    grown, fallen = straight_on(numbers[0], 0.6 * size, predictions[0])
    # of 50 draws from the whole way between both ends the inner nine tenths hold more than eight
    assert ((high - low)[LEVELS:] > 0.8 * (1.0 - fallen) * peaks[LEVELS:]).all()
    assert (grown - 1.0) * (1.0 - fallen) >= 0.0  # the softer end moves farther with less force


def test_without_data_the_case_is_not_run_and_says_so(folder, tmp_path):
    result = run_case(CASES[0])
    assert (result.status, result.note) == (NOT_RUN, "no data")
    assert run_case(CASES[0], tmp_path).note.startswith("no data: ")
    place = tmp_path / "base_isolated_building"
    place.mkdir()
    pq.write_table(pa.table({"time_s": [0.0, 1.0]}), place / "ICA100.parquet")
    with pytest.raises(NotRunError, match="columns table_acceleration, a1, .* are missing; it has time_s"):
        read_motions(tmp_path)


def test_a_folder_that_is_not_there_is_one_message(tmp_path):
    missing = str(tmp_path / "nowhere")
    ended = subprocess.run(
        [sys.executable, "-m", "verification", "--data", missing], capture_output=True, text=True, check=False
    )
    assert ended.returncode == 2
    assert f"--data must be a folder of measured tests, got {missing}" in ended.stderr
    assert "Traceback" not in ended.stderr
