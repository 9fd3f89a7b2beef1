"""The folder of a run: it appears whole or not at all, and says which of its files were altered since.

`checksums.txt` is what `sha256sum` writes, so that `sha256sum -c checksums.txt` checks a folder without this package.
"""

import hashlib
import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError, RecordWarning, why_unread
from wirerope_mj.foundation.regular_files import regular

SCENARIO, SUMMARY = "scenario.toml", "summary.json"
FORMAT = 1  # Of these two files
KIND, MARKS = "run", (SCENARIO, SUMMARY)  # What messages call such a folder, and the files by which it is known
CHECKSUMS = "checksums.txt"
_LINE = re.compile(r"([0-9a-f]{64}) [ *](.+)")
_MOST = 5  # names of files in one message


@dataclass(frozen=True, kw_only=True)
class Alterations:
    """Files of a run that are not as they were written, relative to its folder, in order."""

    altered: tuple[str, ...]  # those with another content
    missing: tuple[str, ...]  # those that were written and are not there
    added: tuple[str, ...]  # those that are there and were not written

    @property
    def intact(self) -> bool:
        """True if every file that was written is there with its content."""
        return not (self.altered or self.missing)

    @property
    def text(self) -> str:
        """One sentence that names the files; "" if there are none."""
        kinds = (("altered", self.altered), ("missing", self.missing), ("added", self.added))
        more = {kind: f" and {len(names) - _MOST} more" for kind, names in kinds if len(names) > _MOST}
        parts = [f"{kind} {', '.join(names[:_MOST])}{more.get(kind, '')}" for kind, names in kinds if names]
        return f"Since the run was written: {'; '.join(parts)}." if parts else ""


def write_checksums(folder: Path) -> None:
    _write(folder, {name: digest_of(folder / name) for name in _names(folder)})


def update_checksums(folder: Path, files: Sequence[Path]) -> None:
    """Set the checksums of files that a command wrote into a run's folder, if it has checksums.

    RecordError if the checksums cannot be read.
    """
    inside = [file.resolve() for file in files if file.resolve().is_relative_to(folder.resolve())]
    if inside and (folder / CHECKSUMS).is_file():
        new = {file.relative_to(folder.resolve()).as_posix(): digest_of(file) for file in inside}
        _write(folder, _read(folder / CHECKSUMS) | new)


def alterations(folder: Path) -> Alterations | None:
    """Return the files of a run's folder that were altered since it was written; None without checksums, as in older runs.

    RecordError if the checksums cannot be read.
    """
    if not (folder / CHECKSUMS).is_file():
        return None
    stored, present = _read(folder / CHECKSUMS), _names(folder)
    return Alterations(
        altered=tuple(name for name in present if name in stored and digest_of(folder / name) != stored[name]),
        missing=tuple(name for name in sorted(stored) if name not in present),
        added=tuple(name for name in present if name not in stored),
    )


def warn_of_alterations(folder: Path) -> None:
    """Issue a RecordWarning if a file of a run was altered or removed since it was written."""
    altered = alterations(folder) if folder.is_dir() else None
    if altered is not None and not altered.intact:
        warnings.warn(f"{folder}: {altered.text}", RecordWarning, stacklevel=2)


def _names(folder: Path) -> list[str]:
    """List the files below a folder, relative to it, but for the file of checksums."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return sorted(name for path in files if (name := path.relative_to(folder).as_posix()) != CHECKSUMS)


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits; RecordError if it cannot be read."""
    try:
        with regular(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise RecordError(f"{path}: {why_unread(error)}") from None


def _write(folder: Path, digests: dict[str, str]) -> None:
    lines = [f"{digest}  {name}\n" for name, digest in sorted(digests.items())]
    with atomic_file(folder / CHECKSUMS) as beside:
        beside.write_text("".join(lines), encoding="utf-8", newline="\n")


def _read(path: Path) -> dict[str, str]:
    """Return the checksums by file."""
    try:
        lines = regular(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        raise RecordError(f"{path}: this is not a text of checksums. {_REMEDY}") from None
    sums = {}
    for number, line in enumerate(lines, start=1):
        match = _LINE.fullmatch(line)
        if match is None:
            raise RecordError(f"{path}: line {number} is not a SHA-256 checksum and a file. {_REMEDY}")
        sums[match[2]] = match[1]
    return sums


_REMEDY = "Take it from another copy of the folder, or remove it: then nothing is known of what was altered."
