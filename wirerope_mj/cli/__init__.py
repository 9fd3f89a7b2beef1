"""The command `wirerope`, as a process: its streams, which may be closed, full or without a reader, its memory, its end."""

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from io import BufferedWriter, FileIO, TextIOWrapper

from wirerope_mj.foundation import interrupts
from wirerope_mj.foundation.unfailing_files import UnfailingFile


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; an error is one message on standard error.

    Without `arguments` they are those of this process, which ends soon after an interrupt, as one that the signal ended.
    """
    if arguments is None:
        _open_streams()  # first: a pipe would take the place of one that is closed
        interrupts.end_soon_after_interrupts()
    try:
        if arguments is None:
            _check_address_space()
        from wirerope_mj.cli import app  # here, since an interrupt may come while it is imported

        code = app.main(arguments)
        sys.stdout.flush()
        failure = getattr(_raw(sys.stdout), "failure", None)  # because of which not all was printed
        if failure and not isinstance(failure, BrokenPipeError):  # of which nobody wanted to read more
            print(f"wirerope: standard output: {failure.strerror}; what was printed is not complete.", file=sys.stderr)
            code = code or 2
    except MemoryError as error:
        print(f"wirerope: {error}", file=sys.stderr)
        code = 2
    except (KeyboardInterrupt, SystemError) as error:
        # A function in C that an interrupt left with its exception set, and a result all the same, is a SystemError.
        if isinstance(error, SystemError) and not interrupts.interrupted_by():
            raise
        print(f"wirerope: {interrupts.MESSAGE}", file=sys.stderr)
        code = interrupts.INTERRUPTED
    if number := interrupts.interrupted_by():
        interrupts.end(number)
    interrupts.end_at_once_after_interrupts()
    return code


# Address space that libraries and their threads reserve, for the smallest run [bytes]; below it some of them end the process.
_LEAST = 3 * 2**30


def _check_address_space() -> None:
    """Raise MemoryError if this process may not have enough address space for what it imports."""
    with suppress(ImportError):  # Windows has no such limit
        import resource

        limit, _ = resource.getrlimit(resource.RLIMIT_AS)
        if 0 <= limit < _LEAST:
            raise MemoryError(
                f"the address space of this process is limited to {limit / 2**20:.0f} MB (ulimit -v), and libraries and their "
                f"threads reserve up to {_LEAST / 2**20:.0f} MB, of which they use a part. Lift that limit, and limit the "
                "memory that is used instead, if any."
            )


def _open_streams() -> None:
    """Open standard streams that are closed, and keep failures to print from ending the command."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:  # closed: else the next file that is opened would take its place
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115 - for the life of the process
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115
    sys.stdout, sys.stderr = _unfailing(sys.stdout), _unfailing(sys.stderr)


def _raw(stream: object) -> object:
    buffer = getattr(stream, "buffer", None)
    return getattr(buffer, "raw", buffer)


def _unfailing(stream: object) -> TextIOWrapper:
    """Return a stream that goes where `stream` does, but never fails; a Windows console stays as it is."""
    assert isinstance(stream, TextIOWrapper)
    if type(_raw(stream)) is not FileIO:
        return stream
    raw = UnfailingFile(stream.fileno(), "wb", closefd=False)
    how = {"encoding": stream.encoding, "errors": stream.errors}
    return TextIOWrapper(
        raw if stream.write_through else BufferedWriter(raw),
        **how, line_buffering=stream.line_buffering, write_through=stream.write_through,
    )  # fmt: skip
