"""A model under the mouse: what edits make of tables and job, and what becomes of statics, modes and verdict."""

import re
import warnings
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from wirerope_mj.engine.from_tables.layout import Layout
from wirerope_mj.engine.simulation.recorder import scene_of
from wirerope_mj.engine.statics.payloads import point_positions
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import Absent, ModelError, ModelWarning, WireRopeError
from wirerope_mj.runs.board.documents import Documents, Texts
from wirerope_mj.runs.board.forms import form_of
from wirerope_mj.runs.board.job_edits import JOB_EDITS
from wirerope_mj.runs.board.loaded import Loaded
from wirerope_mj.runs.board.opened import Opened
from wirerope_mj.runs.board.parts import found_html, loops_of, tried_html
from wirerope_mj.runs.board.placing import EDITS, Placing, shift_of
from wirerope_mj.runs.board.room import overlapping, with_shifted
from wirerope_mj.runs.board.table_edits import TABLE_EDITS
from wirerope_mj.runs.board.table_text import TableText
from wirerope_mj.runs.board.verdicts import Verdicts, at_rest_html
from wirerope_mj.runs.board.what_if import checked_values
from wirerope_mj.runs.board.written import FILES, written
from wirerope_mj.runs.job_file import load_job
from wirerope_mj.views.board import columns
from wirerope_mj.views.board.scene import board_scene

Message = Entries


class Board:
    """Tables and a job that are edited in windows of a browser, all of which show the same.

    What is asked for is answered by messages as the page takes them: what is cheap first, the verdict last.
    """

    def __init__(self, opened: Opened) -> None:
        """Show what was opened; WireRopeError if it is wrong."""
        self._opened, self._documents = opened, opened.documents
        self._verdicts = Verdicts(opened.tests)
        self._found = {"found": "", "loops": ""}  # parts, as HTML
        self._temporary = TemporaryDirectory(prefix="wirerope-board-")
        self._tables: Mapping[str, TableText] = {}  # as they were read last
        self._loaded = self._load(self._texts)
        self._restored = ""
        if self._documents is not None and (left := self._documents.left_unsaved()) is not None:
            self._take(left, "restored what was not saved last time")
            self._restored = "Changes that were not saved last time are here again; Undo takes them back."

    @property
    def _texts(self) -> Texts:
        return {} if self._documents is None else self._documents.texts

    @property
    def title(self) -> str:
        return self._loaded.job.name

    def open(self) -> Message:
        """Return the first message of a window."""
        said = {"said": self._restored, "tone": "warn"} if self._restored else {}
        return {**self._placed(), **said}

    def act(self, action: Entries) -> Generator[tuple[bool, Message], None, None]:
        """Do what a window asks for, and yield messages with whether they are for every window.

        What cannot be done is refused in words, and nothing is changed then.
        """
        try:
            yield from self._answers(str(action.get("do")), action)
        except (WireRopeError, ValueError) as error:
            typed = str(action.get("value", "")).split()
            word = next((quoted for quoted in re.findall(r'"([^"]+)"', str(error)) if quoted in typed), "")
            yield False, {"refused": action.get("id"), "said": _sentence(str(error)), "tone": "bad", "word": word}
            if action.get("do") in EDITS:  # what was shown while it was dragged is not so
                yield from self._verdict()

    def _answers(self, asked: str, action: Entries) -> Iterator[tuple[bool, Message]]:
        passing = action.get("passing") is True
        if asked == "drag":
            by = shift_of(action)
            # dragged back to where it was, the verdict of before is due again
            verdict = {"stale": True} if by.any() else {"ask": {"do": "judge"}}
            yield False, {**self._preview(_names(action), by), **verdict}
        elif asked == "judge":
            yield from self._verdict()
        elif asked == "save":
            names = self._edited_files.save()
            yield True, {"dirty": False, "said": f"Saved: {', '.join(names) or 'nothing has changed'}.", "tone": "good"}
        elif asked in FILES:
            yield from self._written(asked)
        elif asked == "find":
            self._found["found"] = found_html(str(action.get("value", "")))
            yield True, {"html": dict(self._found)}
        elif asked == "loops":
            self._found["loops"] = columns.chart_html(loops_of(str(action.get("value"))))
            yield True, {"html": dict(self._found)}
        elif asked == "try-parts":
            yield False, {"said": "Simulating every part in all places ...", "tone": ""}
            self._found["found"] = tried_html(self._loaded, str(action.get("value", "")))
            yield True, {"html": dict(self._found), "said": "Parts are listed by what they use.", "tone": "good"}
        else:
            said, selected = self._done(asked, action)
            yield True, {**self._placed(sliders=asked == "slide"), "said": _sentence(said), "tone": "", **selected}
            yield from self._verdict(exact=not passing)

    def _done(self, asked: str, action: Entries) -> tuple[str, Message]:
        """Change what the board shows, and return what is said of it, and what is selected then."""
        if asked == "slide":
            values = checked_values(self._loaded.sliders, {**self._loaded.values, str(action.get("key")): _value(action)})
            self._loaded = replace(self._loaded, values=values)
            return "what-if, which no file has" if self._loaded.moved else "every slider stands as the files say", {}
        put_back = "; the sliders are back, since a file is edited without them" if self._loaded.moved else ""
        if asked in ("undo", "redo"):
            files = self._edited_files
            said = files.undo() if asked == "undo" else files.redo()
            if not said:
                return f"there is nothing to {asked}", {}
            self._loaded = self._load(files.texts)
            return f"{'Undone' if asked == 'undo' else 'Done again'}: {said}{put_back}", {}
        texts, said, selected = self._edited(asked, action)
        self._take(texts, said)
        return said + put_back, selected

    def changed_outside(self) -> Message | None:
        """Take over files that others have written; None if there are none."""
        if self._documents is None:
            return None
        texts, both = self._documents.changed_outside()
        said = f"{', '.join(both)} was changed outside, and here, too: Save writes what stands here over it." if both else ""
        if texts == self._documents.texts:
            return {"said": said, "tone": "warn", "dirty": True} if both else None
        try:
            self._take(texts, "change outside of the board")
        except (WireRopeError, ValueError) as error:
            return {"said": f"A file was changed outside, and is wrong: {error} The board keeps what it had.", "tone": "bad"}
        said = said or "A file was changed outside: the board shows what it says now."
        return {**self._placed(), "said": said, "tone": "warn", "ask": {"do": "judge"}}

    def file(self, name: str) -> Path | None:
        """Find a file that was written for the page to open; None if there is none of this name."""
        path = self._folder / name
        return path if any(name in files for files in FILES.values()) and path.is_file() else None

    def close(self) -> None:
        self._temporary.cleanup()
        if self._documents is not None:
            self._documents.close()

    @property
    def _edited_files(self) -> Documents:
        if self._documents is None:
            raise ModelError("a scenario or a run is shown as it is; sliders alone change it.")
        return self._documents

    @property
    def _folder(self) -> Path:
        """The folder of what is written: below the job's, or a temporary one."""
        if self._documents is None:
            return Path(self._temporary.name) / "run"
        job = self._documents.files["job"]
        return job.parent / "runs" / job.stem

    def _load(self, texts: Texts) -> Loaded:
        """Read texts as commands read files; WireRopeError names the files."""
        if self._documents is None:
            assert self._opened.job is not None
            return Loaded({}, self._opened.job, {}, {})
        documents = self._documents
        documents.write_copies(texts)
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", ModelWarning)
                job = load_job(documents.copy("job"))
            known = {kind: table for kind, table in self._tables.items() if table.text == texts.get(kind)}
            read = {kind: TableText.read(kind, documents.copy(kind)) for kind in texts.keys() - known.keys() - {"job"}}
            tables = self._tables = {kind: (known | read)[kind] for kind in texts if kind != "job"}
        except (WireRopeError, ValueError) as error:
            documents.write_copies(documents.texts)
            raise type(error)(str(error).replace(f"{documents.copies}/", "")) from None
        doubts = [str(warning.message) for warning in caught if issubclass(warning.category, ModelWarning)]
        return Loaded(dict(texts), job, tables, {}, doubts)

    def _take(self, texts: Texts, said: str) -> None:
        """Go on to texts that can be loaded, and in which no two mounts stand in each other that did not before."""
        loaded = self._load(texts)
        before = {tuple(pair) for pair in overlapping(self._loaded.system)}
        for pair in overlapping(loaded.system):
            if pair not in before:
                self._edited_files.write_copies(self._texts)
                raise ModelError(f"mounts {pair[0]} and {pair[1]} would stand in each other.")
        self._edited_files.edit(texts, said)
        self._loaded = loaded

    def _edited(self, asked: str, action: Entries) -> tuple[Texts, str, Message]:
        """Return the texts after an edit, what is said of it, and what is selected then."""
        loaded = self._loaded
        selected: Message = {}
        self._edited_files  # noqa: B018  # refused where nothing can be edited
        if asked in EDITS:
            edit, said = EDITS[asked]
            placing = Placing(loaded.tables, self._movable)
            names = _names(action)
            copies = edit(placing, names, action)
            selected = {"selected": copies} if copies else {}
            changed: Mapping[str, str | None] = {
                kind: placing.tables[kind].text if kind in placing.tables else None for kind in loaded.tables
            }
            called = [name.partition("/")[2] for name in names]
            said += f" {', '.join(called) if len(called) < 4 else f'{len(called)} things'}"
        elif asked in TABLE_EDITS:
            changed, said = TABLE_EDITS[asked](loaded.tables, action)
        elif asked in JOB_EDITS:
            text, said = JOB_EDITS[asked](loaded.texts["job"], action)
            changed = {"job": text}
        else:
            raise ModelError(f"there is nothing called {asked[:40]!r} to do.")
        return {kind: text for kind, text in {**loaded.texts, **changed}.items() if text is not None}, said, selected

    @property
    def _movable(self) -> Layout:
        if self._loaded.layout is None:
            raise ModelError("what stands in a model's file is not moved; a board moves what stands in tables.")
        return self._loaded.layout

    def _placed(self, *, sliders: bool = False) -> Message:
        """Return the message that shows what stands where; the right column is of earlier positions until it is known.

        Where sliders alone were moved the forms stay as they are.
        """
        loaded, files = self._loaded, self._documents
        form = form_of(loaded.tables, loaded.texts.get("job", ""), loaded.system, loaded.sliders, loaded.values, loaded.doubts)
        form = replace(form, found=self._found["found"], loops=self._found["loops"])
        return {
            "scene": self._scene(self._loaded, {}), "dirty": files is not None and files.unsaved, "stale": True,
            "html": {"sliders": columns.sliders_html(form)} if sliders else {"left": columns.left_column(form)},
        }  # fmt: skip

    def _scene(self, loaded: Loaded, over: Mapping[str, float], **moved: Any) -> Message:
        """Draw what stands there, or is on its way, with the utilisations `over` in place of the verdict's."""
        points = {f"point/{name}": at for name, at in point_positions(loaded.system).items()}
        points |= {f"force/{point.name}": point.position for point in (loaded.layout.forces if loaded.layout else ())}
        used = {**self._verdicts.used, **over}
        return board_scene(scene_of(loaded.system), loaded.layout, points, used, loaded.sag, **moved)

    def _preview(self, names: Sequence[str], by: Array) -> Message:
        """Return scene, statics and modes of what is on its way, with use of the rated static loads where it is too much."""
        moved = self._dragged(names, by)
        mounts = {} if isinstance(moved.sag, Absent) else moved.sag.mounts
        over = {name: row.utilisation for name, row in mounts.items() if row.utilisation and row.utilisation > 1.0}
        collide = {name for pair in overlapping(moved.system) for name in pair}
        scene = self._scene(moved, over, collide=collide, names=names, by=(1e3 * by).round(6).tolist())
        return {"scene": scene, "html": {"statics": at_rest_html(moved)}}

    def _dragged(self, names: Sequence[str], by: Array) -> Loaded:
        """Return the model with things where they are on their way, on its deck, at its temperature, with its sliders."""
        loaded = self._loaded
        if all(name.startswith(("mount/", "stop/")) for name in names):
            return replace(loaded, job=replace(loaded.job, system=with_shifted(loaded.job.system, loaded.tables, names, by)))
        placing = Placing(loaded.tables, self._movable)
        placing.move(names, by)
        try:
            texts = {**loaded.texts, **{kind: table.text for kind, table in placing.tables.items()}}
            return replace(self._load(texts), values=loaded.values)
        finally:
            self._edited_files.write_copies(self._texts)

    def _verdict(self, *, exact: bool = True) -> Iterator[tuple[bool, Message]]:
        """Judge the load cases and yield what is known of them, or why they cannot be simulated."""
        for html, changes in self._verdicts.of(self._loaded, exact=exact):
            yield (
                True,
                {"html": html, **changes, **({"scene": self._scene(self._loaded, {})} if html.keys() != {"compared"} else {})},
            )

    def _written(self, asked: str) -> Iterator[tuple[bool, Message]]:
        """Write what `wirerope cases` writes of the job, and open a part of it."""
        if self._loaded.moved and self._documents is not None:
            raise ModelError("sliders show what would be; set them back, since a report is of what the files say.")
        lasts = "a film takes minutes" if asked == "film" else "it takes a while"
        said = f"Computing and writing every load case: {lasts}, and what is asked for meanwhile waits."
        yield False, {"said": said, "tone": ""}
        path = written(asked, self._loaded, self._folder, governing=self._verdicts.governing)
        address = f"/viewer?recording={path.name}" if asked == "timeline" else f"/files/{path.name}"
        yield False, {"open": address, "said": f"Written: {path}.", "tone": "good"}


def _sentence(text: str) -> str:
    """End a message as a sentence, and begin it as one unless it begins with a name."""
    first = text.split(" ", 1)[0]
    return f"{text[0].upper()}{text[1:]}{'' if text.endswith('.') else '.'}" if first.isalpha() else f"{text.rstrip('.')}."


def _names(action: Entries) -> list[str]:
    names = action.get("names")
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        raise ModelError("nothing is selected.")
    return names


def _value(action: Entries) -> float:
    try:
        return float(action.get("value", ""))
    except (TypeError, ValueError):
        raise ModelError("a slider stands at a number.") from None
