"""Standing in somebody else's folder: no command executes, imports or unpickles anything of it."""

import sys

import pytest
from hostile_commands import COMMANDS, colleague, faults

from wirerope_mj.cli import app

pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither pipes in folders nor modes of files"),
    pytest.mark.filterwarnings("ignore:the given step of"),  # what is asked here holds at coarse steps
]


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """Return a folder with a run, its model, a study and a record, as a colleague would send it."""
    folder = tmp_path_factory.mktemp("colleague") / "inbox"
    colleague(folder)
    return folder


def test_every_command_stands_in_a_hostile_folder():
    assert {words[0] for words in COMMANDS} == set(app.COMMANDS)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(20))
def test_no_command_executes_anything_of_the_folder_it_stands_in(number, data, tmp_path):
    """More than these twenty: `python tests/fuzz/campaign.py hostile --inputs 200`."""
    assert faults(number, data, tmp_path)[1] == []
