"""The command `wirerope`."""

import sys
from collections.abc import Sequence

from wirerope_mj.cli import process
from wirerope_mj.foundation import interrupts


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error is one message on standard error.

    Without `arguments` they are those of this process, which ends soon after an interrupt, as one that the signal ended.
    """
    if arguments is None:
        process.open_streams()  # first: a pipe would take the place of one that is closed
        interrupts.end_soon_after_interrupts()
    try:
        if arguments is None:
            process.check_address_space()
        from wirerope_mj.cli import app  # here, since an interrupt may come while it is imported

        code = app.main(arguments)
    except MemoryError as error:
        print(f"wirerope: {error}", file=sys.stderr)
        code = 2
    except KeyboardInterrupt:
        print(f"wirerope: {interrupts.MESSAGE}", file=sys.stderr)
        code = interrupts.INTERRUPTED
    if number := interrupts.interrupted_by():
        interrupts.end(number)
    interrupts.end_at_once_after_interrupts()
    return code
