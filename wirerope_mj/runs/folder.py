"""The folder of a run, which appears whole or not at all."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from wirerope_mj.foundation.atomic_files import atomic_folder, check_folder

SCENARIO, SUMMARY = "scenario.toml", "summary.json"
FORMAT = 1  # Of these two files


def check_target(folder: Path, *, force: bool, kind: str = "run", marks: Sequence[str] = (SCENARIO, SUMMARY)) -> None:
    """Raise RecordError unless a run may be written to `folder`, or another `kind` of folder, known by its `marks`."""
    check_folder(folder, force=force, kind=kind, marks=marks)


@contextmanager
def atomic_run(
    folder: Path, *, force: bool, kind: str = "run", marks: Sequence[str] = (SCENARIO, SUMMARY)
) -> Iterator[Path]:
    """Yield a new folder that becomes the run `folder` when the block ends well; arguments as those of `check_target`."""
    with atomic_folder(folder, force=force, kind=kind, marks=marks) as beside:
        yield beside
