"""Commands that are killed at random leave nothing that the next command does not clear; `kills.py` does it often."""

import sys

import pytest
from kills import COMMANDS, campaign


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither these signals nor these locks")
@pytest.mark.parametrize("name", COMMANDS)
def test_what_a_killed_command_leaves_the_next_one_clears(tmp_path, name):
    counts = campaign(name, 2, seed=1, place=tmp_path)
    assert counts["kills"] == 2
    assert {what: counts[what] for what in ("complete and false", "left after the next command", "other results")} == {
        "complete and false": 0, "left after the next command": 0, "other results": 0,
    }  # fmt: skip
