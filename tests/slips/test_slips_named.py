"""Classic slips are named by their cause, inputs without any left in peace; `python -m tests.slips` prints the table."""

import pytest

from tests.slips.__main__ import bases, slips
from tests.slips.foreign_inputs import foreign_inputs
from tests.slips.planting import planted, told
from tests.slips.unusual_inputs import unusual_inputs

EVERY = slips()
PAIRS = [(slip, base) for slip in EVERY for base in slip.bases]


def faults(pairs, folder):
    """Return the slips that are not named though they can be told."""
    outcomes = [planted(slip, base, folder / str(number)) for number, (slip, base) in enumerate(pairs)]
    return [(o.slip.name, o.base.name, o.sentences) for o in outcomes if not o.named and not o.slip.untold]


@pytest.mark.slow
@pytest.mark.parametrize("part", range(8))
def test_slips_are_named(part, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its log there
    assert faults(PAIRS[part::8], tmp_path) == []


def test_a_sample_of_slips_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert faults(PAIRS[::25], tmp_path) == []


@pytest.mark.slow
def test_nothing_is_said_of_what_is_rare_and_right(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = {base.name: told(base, tmp_path / str(number)) for number, base in enumerate(unusual_inputs())}
    assert {name: sentences for name, sentences in said.items() if sentences} == {}


def test_nothing_is_said_of_a_fifth_of_foreign_inputs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = {base.name: told(base, tmp_path / base.name) for base in foreign_inputs()[::5]}
    assert {name: sentences for name, sentences in said.items() if sentences} == {}
    assert len(said) == 10


@pytest.mark.slow
def test_nothing_is_said_of_what_is_right(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = {base.name: told(base, tmp_path / base.name) for base in (*bases(EVERY), *foreign_inputs())}
    assert {name: sentences for name, sentences in said.items() if sentences} == {}
    assert len(said) >= 5
