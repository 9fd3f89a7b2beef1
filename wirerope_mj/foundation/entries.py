"""The type of what stands in a table by its key and nothing has checked yet."""

from typing import Any

# A table of TOML or JSON, options of a command, arguments to pass on: of any type until the code that takes them checks them.
Entries = dict[str, Any]
