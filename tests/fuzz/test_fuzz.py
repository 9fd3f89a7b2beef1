"""A few inputs of every fuzz target, in this process; campaigns of thousands are run by `campaign.py`."""

import pytest
from campaign import ACCEPTED, FAULTS, MODULES, attempt, target


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(MODULES.keys() - {"hostile"}))  # those stand in tests/runs/test_hostile_folders.py
def test_mutated_inputs_are_used_or_refused_in_words(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its log there
    outcomes = [attempt(target(name), seed) for seed in range(8 if name == "commands" else 25)]  # those take 0.5 s each
    assert [outcome for outcome in outcomes if outcome.kind in FAULTS] == []


def test_of_inputs_that_are_accepted_as_they_stand_most_still_are(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcomes = [attempt(target("meant"), seed).kind for seed in range(25, 65)]
    assert not {*outcomes} & {*FAULTS}
    assert outcomes.count(ACCEPTED) >= 0.4 * len(outcomes)
