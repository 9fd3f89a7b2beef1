"""Cyclic records whose time, length or pauses are wrong or unusual are named by their cause."""

import numpy as np
import pytest
from rig_faults import LAW, SIZES
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.mounts.identification.records import read_tests, rig_warnings
from wirerope_mj.mounts.test_rig.faults import checked_record


def test_half_a_cycle_says_that_it_turns_round_once(tmp_path):
    time, deflection, force = (values[:101] for values in rig_record(LAW, [8e-3], points=200.0, noise=0.0))
    file = write_record(tmp_path / "half.csv", time, deflection, force)
    with pytest.raises(wr.RecordError) as refused:
        read_tests([file])
    assert "its deflection turning round only once, as in half a cycle" in str(refused.value)
    assert f"ends {abs(force[-1] - force[0]):.3g}"[:7] in str(refused.value)


@pytest.mark.parametrize(
    ("header", "text"),
    [
        ("time [s],deflection [mm],force [kN]", "is its time in ms where the header says s"),
        ("", "in s where the header says ms"),
    ],
)
def test_a_time_in_another_unit_than_its_header_is_named(tmp_path, header, text):
    time, deflection, force = rig_record(LAW, SIZES, cycles=3)
    header = header or "time [ms],deflection [mm],force [kN]"
    file = write_record(tmp_path / "test.csv", 1e3 * time if "[s]" in header else time, deflection, force, header=header)
    try:
        said = rig_warnings(read_tests([file]))[0]
    except wr.RecordError as error:
        said = [str(error)]
    assert any(text in sentence for sentence in said)


def test_a_pause_between_amplitudes_is_no_fault():
    time, deflection, force = rig_record(LAW, SIZES)
    assert checked_record(time + 3600.0 * (time >= 5.0), deflection, force).faults == []


def test_a_drift_shows_in_four_cycles_of_each_amplitude():
    time, deflection, force = rig_record(LAW, SIZES, cycles=4)
    assert not any("drifts" in text for text in checked_record(time, deflection, force).faults)
    faults = checked_record(time, deflection, force + 400.0 * time / time[-1]).faults
    assert any("the zero of the force drifts" in text for text in faults)


def test_friction_that_slips_early_is_no_lag():
    phase = np.linspace(0.0, 2.0 * np.pi, 101)[1:]
    deflection = np.concatenate([[0.0]] + [size * np.sin(phase) for size in (0.004, 0.012, 0.03) for _ in range(3)])
    clean = wr.load_isolator("enidine_wr16_400").shear.trace(deflection).force
    noise = 1e-3 * np.ptp(clean) * np.random.default_rng(0).standard_normal(clean.size)
    for force in (clean, clean + noise):
        assert checked_record(0.02 * np.arange(force.size), deflection, force).faults == []
