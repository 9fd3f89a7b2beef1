"""`wirerope laws`: the comparison of laws from the command line."""

import pytest
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.cli import main

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


def test_an_unknown_law_is_refused(record, capsys):
    assert main(["laws", record.name, "--law", "hooke"]) == 2
    assert "there is no law 'hooke'; the laws are" in capsys.readouterr().err
