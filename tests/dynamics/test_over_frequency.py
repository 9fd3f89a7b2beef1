"""The tab of a recording with what stands over frequency, read back from its file, and contacts beside it."""

import numpy as np
import pytest
from house import sdof
from recordings import column, entities

import wirerope_mj as wr
from wirerope_mj.content.first_sheet import panel_over_frequency
from wirerope_mj.content.judged_run import judged_run
from wirerope_mj.views.recording.record import record_run

G = wr.STANDARD_GRAVITY


@pytest.fixture(scope="module")
def mass():
    return sdof(wr.KelvinVoigt(k=4e4, c=120.0))


def recorded(system, response, motion, path):
    """Return what is drawn over frequency, and the entities of the recording."""
    run = judged_run(system, motion, response)
    panel = panel_over_frequency(run)
    record_run(run, path, over_frequency=panel)
    return panel, entities(path)


def over_time(batches):
    """Return the instants [s] of a batch on the timeline of the simulation, and the batch."""
    batch = next(batch for batch in batches if "sim_time" in batch.schema.names)
    return np.asarray(batch["sim_time"]).astype("timedelta64[ns]").astype(float) * 1e-9, [batch]


def test_the_cursor_of_a_sweep_stands_at_the_frequency_of_the_instant(mass, tmp_path):
    sweep = wr.Sweep(start=2.0, stop=20.0, rate=60.0, acceleration=0.5 * G, direction="z")
    response = wr.simulate(mass, sweep, duration=sweep.duration, timestep=1e-3)
    _, found = recorded(mass, response, sweep, tmp_path / "run.rrd")
    times, now = over_time(found["/frequencies/data/now"])
    places = np.array([spot[0] for spot in column(now, "Points2D:positions").to_pylist()])
    octaves = np.log2(10.0 ** places[:, 0] / 2.0)
    np.testing.assert_allclose(octaves, times * 60.0 / 60.0, atol=1e-5)  # an octave a second; positions are float32
    assert column(now, "Points2D:labels")[0].as_py() == ["2 Hz"]


def test_densities_and_shock_spectra_are_drawn_as_they_are(mass, tmp_path):
    random = wr.RandomVibration(psd=[(5.0, 1.0), (100.0, 1.0)], duration=6.0, direction="z", seed=1)
    shock = wr.HalfSine(peak=5.0 * G, duration=0.011, direction="z", start=0.05)
    for motion, duration in ((random, 6.0), (shock, 0.5)):
        response = wr.simulate(mass, motion, duration=duration, timestep=1e-3)
        panel, found = recorded(mass, response, motion, tmp_path / f"{duration}.rrd")
        curve = next(curve for curve in panel.curves if curve.name.partition(",")[0] == "mass")
        (path,) = [one for one in found if one.startswith("/frequencies/data/mass") and not one.endswith("/peak")]
        line = np.array(column(found[path], "LineStrips2D:strips")[0][0].as_py())
        across = 10.0 ** line[:, 0]
        np.testing.assert_allclose(across, curve.x[: across.size], rtol=1e-5)
        expected = np.maximum(curve.y[: across.size], panel.ylim[0])
        np.testing.assert_allclose(10.0 ** line[:, 1], expected, rtol=1e-5)
        assert "/frequencies/data/now" not in found
