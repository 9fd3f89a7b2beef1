"""`wirerope laws`: the comparison of laws from the command line."""

import numpy as np
import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.mounts.identification import compare_laws

TRUTH = wr.EnhancedDryFriction(k=6e4, d=400.0, u_c=1e-3)


@pytest.fixture
def record(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return write_record(tmp_path / "test.csv", *rig_record(TRUTH, [1e-3, 3e-3, 10e-3], points=100.0))


def test_the_law_of_the_device_is_named(record, capsys):
    assert main(["laws", record.name, "--law", "bouc-wen", "enhanced-dry-friction"]) == 0
    out = capsys.readouterr().out
    assert out.splitlines()[1].startswith("enhanced-dry-friction")
    assert "enhanced-dry-friction has the best criterion" in out
    assert "wirerope identify test.csv --law" in out


@pytest.mark.slow
def test_a_law_that_fits_far_better_is_recommended_where_too_few_amplitudes_leave_none_out(tmp_path, monkeypatch, capsys):
    """Three amplitudes: eight parameters cannot be fitted to two of them, and Bouc-Wen's five, which can, miss by half."""
    monkeypatch.chdir(tmp_path)
    device = wr.AsymmetricBoucWen(alpha=4e5, beta=200.0, gamma=-60.0, n=1.0, k1=4e4, k2=4e6, k3=4e8, b=2.7, c=60.0)
    write_record(tmp_path / "test.csv", *rig_record(device, [2e-3, 8e-3, 18e-3], points=200.0))
    assert main(["laws", "test.csv", "--law", "bouc-wen", "asymmetric-bouc-wen"]) == 0
    out = capsys.readouterr().out
    assert "asymmetric-bouc-wen has no error on an amplitude left out" in out
    assert "wirerope identify test.csv --law asymmetric-bouc-wen" in out
    assert "±18 mm; of larger ones they say nothing" in out


def test_errors_are_those_of_an_identification(record):
    loops = wr.load_cycles(record)
    row = compare_laws(loops, laws=[wr.BoucWen], leave_out=False).best
    np.testing.assert_allclose(row.errors, row.fit.residuals, rtol=1e-12)


def test_an_unknown_law_is_refused(record, capsys):
    assert main(["laws", record.name, "--law", "hooke"]) == 2
    assert "there is no law 'hooke'; the laws are" in capsys.readouterr().err
