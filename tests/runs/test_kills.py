"""Commands that are killed or interrupted at random leave nothing; `kills.py` and `interrupts.py` do it often."""

import math
import sys

import interrupts
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


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks for what is left as Linux lists processes")
@pytest.mark.parametrize("name", ["run", "export", "study"])
def test_an_interrupted_command_says_so_and_leaves_the_old_or_the_new(tmp_path, name):
    counts = interrupts.campaign(name, 4, seed=1, place=tmp_path, soon=math.inf)  # a busy machine is no fault here
    assert counts["times"] == 4
    assert counts["wrong"] == 0
