"""Amplitude tables that dwell at the response prominences of a model, against closed forms."""

import numpy as np
import pytest
from house import sdof, sdof_text

import wirerope_mj as wr
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.runs.said_motion import prominences, with_dwells_found

MASS = 3.5


def spring(frequency, damping=0.05):
    omega = 2.0 * np.pi * frequency
    return wr.KelvinVoigt(k=MASS * omega**2, c=2.0 * damping * omega * MASS)


@pytest.mark.parametrize("natural", [6.6, 9.2])
def test_a_linear_mount_is_found_at_the_line_of_its_largest_transmissibility(natural):
    """T = sqrt((1 + (2 D r)^2) / ((1 - r^2)^2 + (2 D r)^2)), r = f / natural; the level does not matter."""
    lines = [(float(f), 0.5e-3 if f < 8 else 0.2e-3) for f in range(4, 14)]
    r = np.array([f for f, _ in lines]) / natural
    curve = np.sqrt((1 + (0.1 * r) ** 2) / ((1 - r**2) ** 2 + (0.1 * r) ** 2))
    assert prominences(sdof(spring(natural)), "displacement", lines, "z") == [lines[int(curve.argmax())][0]]


def test_beyond_its_resonance_the_first_frequency_is_the_only_candidate():
    assert prominences(sdof(spring(2.0)), "velocity", [(f, 1e-3) for f in (4.0, 5.0, 6.0)], "z") == [4.0]


def test_a_load_case_says_where_it_dwells(tmp_path):
    (tmp_path / "table.csv").write_text("from [Hz], to [Hz], displacement [mm]\n4, 12, 0.2\n")
    sdof(spring(9.2)).isolators["a"].save(tmp_path / "a.toml")
    (tmp_path / "m.xml").write_text(sdof_text(mass=MASS))
    case = '[[case]]\nname = "table"\namplitude-table = "table.csv 3 s z dwell 20 s"\n'
    (tmp_path / "job.toml").write_text(f'model = "m.xml"\n{case}')
    (made,) = load_job(tmp_path / "job.toml").cases
    assert made.scenario.options["amplitude-table"] == "table.csv 3 s z dwell 20 s 9 Hz"
    assert made.scenario.motion.end == pytest.approx(9 * 3.0 + 20.0)
    (tmp_path / "job.toml").write_text(f'model = "m.xml"\n{case}'.replace("s z", "s xz"))
    with pytest.raises(wr.ModelError, match="one direction"):
        load_job(tmp_path / "job.toml")


def test_what_needs_no_finding_stays_as_it_is():
    said = [("half-sine", "15 g 11 ms z"), ("amplitude-table", "t.csv 3 s z")]
    assert with_dwells_found(said, sdof(spring(9.2))) == said
