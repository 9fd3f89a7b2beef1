"""The files that a board edits, as texts: with undo and redo, a journal against crashes, and a watch on other programs."""

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
        self.copies = Path(self._temporary.name)  # that stands for the folder of all files in the paths of copies
        job = self.files.get("job", self.copies / "run")
        self._root = Path(os.path.commonpath([job.parent, *(file.parent for file in self.files.values())]))
        self.folder = job.parent
        self._journal = self.folder / JOURNAL
        self.written = self.folder / "runs" / job.stem  # folder of what is written of it

    @property
    def texts(self) -> Texts:
        return self._states[self._now][0]

    @property
    def unsaved(self) -> bool:
        return self.texts != self._saved

    def copy(self, kind: str, copies: Path | None = None) -> Path:
        return (copies or self.copies) / self.files[kind].relative_to(self._root)

    def write_copies(self, texts: Texts, copies: Path | None = None) -> None:
        """Write texts to the copies of the files, in the temporary folder or in `copies`."""
        ours = {path for file in self.files.values() for path in (file, *file.parents)}
        for folder in sorted(path for path in ours - {*self.files.values()} if path.is_relative_to(self._root)):
            copy = (copies or self.copies) / folder.relative_to(self._root)
            copy.mkdir(exist_ok=True)
            for entry in folder.iterdir() if folder.is_dir() else ():
                if entry not in ours and not (copy / entry.name).is_symlink():
                    (copy / entry.name).symlink_to(entry)
        for kind in self.files:
            self._write(kind, self.copy(kind, copies), texts)

    def edit(self, texts: Texts, said: str) -> None:
        """Make `texts` the current ones, a step that can be undone; steps that were undone are forgotten."""
        if texts != self.texts:
            self._states[self._now + 1 :] = [(dict(texts), said)]
            self.step(1)
            self._edited |= {kind: text for kind, text in self._saved.items() if texts.get(kind) == text}

    def step(self, by: int) -> str:
        """Undo the last edit, -1, or redo the next, 1, and return the phrase that says what it did; "" if there is none."""
        if not 0 <= self._now + by < len(self._states):
            return ""
        said = self._states[max(self._now, self._now + by)][1]
        self._now += by
        if self.unsaved:
            with atomic_file(self._journal) as beside:
                beside.write_text(json.dumps(self.texts), encoding="utf-8")
        else:
            self._journal.unlink(missing_ok=True)
        return said

    def save(self) -> list[str]:
        """Write the texts that differ from the files, each atomically; return the files' names, marked where one is removed."""
        names = [kind for kind in self.files if self.texts.get(kind) != self._saved.get(kind)]
        for kind in names:
            self._write(kind, self.files[kind], self.texts)
        self._saved, self._edited = dict(self.texts), dict(self.texts)
        self._journal.unlink(missing_ok=True)
        return [f"{self.files[kind].name}{'' if kind in self.texts else ' (taken away)'}" for kind in names]

    def changed_outside(self) -> tuple[Texts, list[str]]:
        """Return the texts as other programs left their files, and the names of files that were changed both there and here."""
        disk = self._on_disk()
        changed = [kind for kind in self.files if disk.get(kind) != self._saved.get(kind)]
        both = [kind for kind in changed if self.texts.get(kind) not in (self._edited.get(kind), disk.get(kind))]
        taken = {kind: disk.get(kind) for kind in changed if kind not in both}
        self._saved = disk
        texts = {kind: text for kind, text in {**self.texts, **taken}.items() if text is not None}
        return texts, [self.files[kind].name for kind in both]

    def left_unsaved(self) -> Texts | None:
        """Return the texts that a process left in the journal when it ended without saving; None if there are none."""
        try:
            texts = json.loads(self._journal.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        right = isinstance(texts, dict) and all(kind in self.files and isinstance(text, str) for kind, text in texts.items())
        return texts if right and texts != self.texts else None

    def close(self) -> None:
        self._temporary.cleanup()

    def _write(self, kind: str, path: Path, texts: Texts) -> None:
        """Write the text of a kind of file to a path, or remove the file if there is none."""
        content = texts.get(kind, "").encode(self._encodings.get(kind, "utf-8"))
        if kind not in texts:
            path.unlink(missing_ok=True)
        elif not path.is_file() or path.read_bytes() != content:
            with atomic_file(path) as beside:
                beside.write_bytes(content)

    def _on_disk(self) -> Texts:
        """Read the files that exist; RecordError if one is unreadable."""
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
