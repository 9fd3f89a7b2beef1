"""Exit codes of the command."""

BAD_INPUT, INTERRUPTED, DIFFERENT = 2, 130, 1
"""An input is wrong; Ctrl-C, as shells count it; a replay gives other numbers."""
