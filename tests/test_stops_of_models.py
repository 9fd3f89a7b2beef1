"""Bump stops of the models of the house: where they close, what they carry, and that contacts say nearly the same."""

import numpy as np
import pytest

import wirerope_mj as wr
from wirerope_mj.resources import models_folder

G = wr.STANDARD_GRAVITY


def hard_shock():
    return wr.HalfSine(peak=60.0 * G, duration=0.011, direction="z", start=0.05)


def table(name):
    return wr.simulate(wr.load_system(models_folder() / name), hard_shock(), duration=0.12, timestep=1e-5)


def test_contacts_and_stops_of_one_table_say_nearly_the_same():
    """The same gap, k and c: what differs is the first millimetre, and what MuJoCo makes of k."""
    stops = table("shock_table.xml")
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
