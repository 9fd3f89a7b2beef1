"""Faults that do not depend on each other, said together: one error, with those of the others as its notes."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TypeVar

from wirerope_mj.foundation.errors import WireRopeError

T = TypeVar("T")
R = TypeVar("R")
_MOST = 20  # faults of one file that are said: more have one cause, such as a wrong column


class Faults:
    """Errors of parts of a file that are each read whatever is wrong with others: the first is raised, the rest its notes."""

    def __init__(self) -> None:
        self.errors: list[Exception] = []

    @contextmanager
    def apart(self) -> Iterator[None]:
        """Collect an error of this block, so that what follows the block is read, too; it is raised at the end."""
        try:
            yield
        except (WireRopeError, ValueError) as error:
            self.errors.append(error)
            if len(self.errors) >= _MOST:
                raise

    def __enter__(self) -> "Faults":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _trace: TracebackType | None) -> None:
        """Raise the first error with the others as notes; an error that ends the whole block comes last."""
        if error is not None and not isinstance(error, WireRopeError | ValueError):
            return
        ended = [error] if isinstance(error, Exception) and error not in self.errors else []
        texts = dict.fromkeys(text for one in (*self.errors, *ended) for text in texts_of(one))
        if texts:
            first = (*self.errors, *ended)[0]
            first.__notes__ = [text for text in texts if text != str(first)]
            raise first


def each(read: Callable[[T], R], items: Iterable[T]) -> list[R]:
    """Read all items, also those after a faulty one; the first error is raised at the end, with the others as its notes."""
    results = []
    with Faults() as faults:
        for item in items:
            with faults.apart():
                results.append(read(item))
    return results


def reworded(error: Exception, word: Callable[[str], Exception]) -> Exception:
    """Make a new error of an error's message by `word`, and its notes of the error's notes in the same way."""
    first, *others = map(word, texts_of(error))
    first.__notes__ = [str(other) for other in others]
    return first


def texts_of(error: Exception) -> tuple[str, ...]:
    """List the message of an error and its notes, which are the messages of the others found with it."""
    return (str(error), *getattr(error, "__notes__", ()))
