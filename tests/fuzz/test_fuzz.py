"""A few inputs of each fuzz target in the tests; campaigns of thousands are run by `campaign.py`."""

import pytest
from campaign import FAULTS, attempt, target


@pytest.mark.parametrize("name", ["models", "isolators", "records", "cycles", "folders"])
def test_no_mutated_input_gets_another_answer_than_a_documented_one(name):
    outcomes = [attempt(*target(name), seed) for seed in range(25)]
    assert not [outcome for outcome in outcomes if outcome.kind in FAULTS]
