"""The files that a board edits, as texts: undone and redone without end, saved whole, kept from crashes, watched."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from wirerope_mj.foundation.atomic_files import atomic_file
from wirerope_mj.foundation.errors import RecordError, why_unread
from wirerope_mj.foundation.regular_files import encoding_of, regular

JOURNAL = ".board-journal.json"  # unsaved texts, beside the job

Texts = Mapping[str, str]  # of the files that are there, by their kinds


class Documents:
    """Texts of files by their kinds, and a copy of them in a temporary folder, in which all other files are linked.

    What reads the copies finds what the files name relative to themselves.
    """

    def __init__(self, files: Mapping[str, Path], new: Texts) -> None:
        """Read the files that are there; the others have the text that `new` has, if any. RecordError if one is unreadable."""
        self.files = {kind: Path(os.path.abspath(file)) for kind, file in files.items()}
        self._encodings = {kind: encoding_of(file) for kind, file in self.files.items() if file.is_file()}
        self._saved = self._on_disk()
        self._edited = dict(self._saved)  # what was on disk as the texts were last the same
        self._states: list[tuple[Texts, str]] = [({**new, **self._saved}, "")]  # texts, and what made them so
        self._now = 0
        self._temporary = TemporaryDirectory(prefix="wirerope-board-")
        self.root = Path(os.path.commonpath([file.parent for file in self.files.values()]))
        self._journal = self.files["job"].parent / JOURNAL
        self._written: Texts = {}

    @property
    def texts(self) -> Texts:
        return self._states[self._now][0]

    @property
    def unsaved(self) -> bool:
        return self.texts != self._saved

    @property
    def copies(self) -> Path:
        """Folder that stands for `root` in the paths of copies."""
        return Path(self._temporary.name)

    def copy(self, kind: str) -> Path:
        return self.copies / self.files[kind].relative_to(self.root)

    def write_copies(self, texts: Texts) -> None:
        """Make the copies those of some texts."""
        for kind, file in self.files.items():
            for folder in [parent for parent in file.parents if parent.is_relative_to(self.root)][::-1]:
                there = self.copies / folder.relative_to(self.root)
                there.mkdir(exist_ok=True)
                ours = {path for other in self.files.values() for path in (other, *other.parents)}
                for entry in folder.iterdir() if folder.is_dir() else ():
                    if entry not in ours and not (there / entry.name).is_symlink():
                        (there / entry.name).symlink_to(entry)
            if texts.get(kind) != self._written.get(kind):
                if kind in texts:
                    self.copy(kind).write_bytes(texts[kind].encode(self._encodings.get(kind, "utf-8")))
                else:
                    self.copy(kind).unlink(missing_ok=True)
        self._written = dict(texts)

    def edit(self, texts: Texts, said: str) -> None:
        """Go on to other texts; what was undone is forgotten."""
        if texts != self.texts:
            self._states[self._now + 1 :] = [(dict(texts), said)]
            self._step(1)
            self._edited |= {kind: text for kind, text in self._saved.items() if texts.get(kind) == text}

    def undo(self) -> str:
        """Go back to the texts before the last edit, and return what that was; "" if there is none."""
        said = self._states[self._now][1]
        if self._now:
            self._step(-1)
        return said

    def redo(self) -> str:
        if self._now + 1 == len(self._states):
            return ""
        self._step(1)
        return self._states[self._now][1]

    def save(self) -> list[str]:
        """Write the files that differ, each whole, and return their names."""
        names = [kind for kind in self.files if self.texts.get(kind) != self._saved.get(kind)]
        for kind in names:
            if kind in self.texts:
                with atomic_file(self.files[kind]) as beside:
                    beside.write_bytes(self.texts[kind].encode(self._encodings.get(kind, "utf-8")))
            else:
                self.files[kind].unlink(missing_ok=True)
        self._saved, self._edited = dict(self.texts), dict(self.texts)
        self._journal.unlink(missing_ok=True)
        return [self.files[kind].name for kind in names]

    def changed_outside(self) -> tuple[Texts, list[str]]:
        """Return the texts with those that others have written, and the names of files that were changed here, too."""
        disk = self._on_disk()
        changed = [kind for kind in self.files if disk.get(kind) != self._saved.get(kind)]
        both = [kind for kind in changed if self.texts.get(kind) not in (self._edited.get(kind), disk.get(kind))]
        taken = {kind: disk.get(kind) for kind in changed if kind not in both}
        self._saved = disk
        texts = {kind: text for kind, text in {**self.texts, **taken}.items() if text is not None}
        return texts, [self.files[kind].name for kind in both]

    def left_unsaved(self) -> Texts | None:
        """Return the texts that a process that ended without saving has left; None if there are none."""
        try:
            texts = json.loads(self._journal.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        right = isinstance(texts, dict) and all(kind in self.files and isinstance(text, str) for kind, text in texts.items())
        return texts if right and texts != self.texts else None

    def close(self) -> None:
        self._temporary.cleanup()

    def _step(self, by: int) -> None:
        self._now += by
        if self.unsaved:
            with atomic_file(self._journal) as beside:
                beside.write_text(json.dumps(self.texts), encoding="utf-8")
        else:
            self._journal.unlink(missing_ok=True)

    def _on_disk(self) -> Texts:
        texts = {}
        for kind, file in self.files.items():
            try:
                with regular(file).open(encoding=self._encodings.get(kind, "utf-8"), newline="") as opened:
                    texts[kind] = opened.read()
            except FileNotFoundError:
                continue
            except (OSError, UnicodeDecodeError) as error:
                why = why_unread(error) if isinstance(error, OSError) else "It is not text."
                raise RecordError(f"{file}: this cannot be read. {why}") from None
        return texts
