"""Commands that stand in folders full of settings, code and data of somebody else's: nothing of them is executed."""

import sys
import tempfile
from functools import cache
from pathlib import Path

from campaign import Case

sys.path.append(str(Path(__file__).parents[1]))
from hostile_commands import colleague, faults


@cache
def inbox():
    """Return a folder as a colleague would send it, written once a process."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-inbox-")) / "inbox"
    colleague(folder)
    return folder


def hostile(rng, folder):
    """One of the commands in a copy of the folder made hostile."""
    number = int(rng.integers(10**6))
    return Case(f"folder {number}", lambda: "; ".join(faults(number, inbox(), folder)[1]) or None)
