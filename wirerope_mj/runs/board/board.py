"""The model on the drawing board: edits of its tables and job, and the statics, modes and verdict that follow."""

import re
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from wirerope_mj.engine.system import System
from wirerope_mj.engine.system.varied import varied
from wirerope_mj.foundation.arrays import Array, Entries
from wirerope_mj.foundation.errors import Absent, ModelError, WireRopeError
from wirerope_mj.motions.registry import SPOKEN_MOTIONS
from wirerope_mj.runs.board.documents import Texts
from wirerope_mj.runs.board.forms import form_of
from wirerope_mj.runs.board.job_text import JOB_EDITS, edited_job
from wirerope_mj.runs.board.loaded import Loaded, load
from wirerope_mj.runs.board.opened import Opened
from wirerope_mj.runs.board.parts import SEARCHES, Trial
from wirerope_mj.runs.board.placing import PLACED, TABLE_EDITS, edited_tables, names_of, shift_of
from wirerope_mj.runs.board.verdicts import Verdicts, at_rest_html
from wirerope_mj.runs.board.what_if import variant, with_slider
from wirerope_mj.runs.board.written import FILES, Order
from wirerope_mj.runs.room import overlapping
from wirerope_mj.runs.scenario import Scenario
from wirerope_mj.views.board.columns import fragment
from wirerope_mj.views.board.scene import board_scene

Message = Entries
Waited = Future[Any]  # what another process computes


class Board:
    """Tables and a job that are edited in windows of a browser, all of which show the same.

    Requests of a window are answered by messages for the page: first what is quickly computed, the verdict last.
    """

    def __init__(self, opened: Opened) -> None:
        """Load what was opened; WireRopeError if it is wrong."""
        self._documents = opened.documents
        self._verdicts = Verdicts(opened.tests)
        self._found = {"found": "", "loops": ""}  # parts, as HTML
        self._trial = Trial()
        self._restored = ""
        self._renamed: dict[tuple[str, str], str] = {}  # rows of tables, by what a window may still call them
        self._writing: Future[Path | str] | None = None  # the last one
        self._loaded = Loaded({}, opened.job, {}, {}) if opened.job else load(self._documents, self._documents.texts, {})
        if (left := self._documents.left_unsaved()) is not None:
            self._take(left, "restored what was not saved last time")
            self._restored = "Changes that were not saved last time are here again; Undo takes them back."

    @property
    def title(self) -> str:
        return self._loaded.job.name

    def open(self) -> Message:
        """Return the first message of a window."""
        said = {"said": self._restored, "tone": "warn"} if self._restored else {}
        return {**self._placed(), **said}

    def act(self, action: Entries) -> Generator[tuple[bool, Message | Waited], None, None]:
        """Carry out a window's request, and yield messages, each with whether it is for every window.

        A request that cannot be carried out changes nothing, and the message says why. In place of a message may be a future
        of another process, for which the window waits.
        """
        try:
            yield from self._answers(str(action.get("do")), action)
        except (WireRopeError, ValueError) as error:
            typed = str(action.get("value", "")).split()
            word = next((quoted for quoted in re.findall(r'"([^"]+)"', str(error)) if quoted in typed), "")
            yield False, {"refused": action.get("id"), "said": _sentence(_reason(str(error))), "tone": "bad", "word": word}
            if action.get("do") in PLACED:  # what was shown while it was dragged is not so
                yield from self._verdict()

    def _answers(self, asked: str, action: Entries) -> Iterator[tuple[bool, Message | Waited]]:
        """Carry out the request called `asked`, and yield messages as `act` does; WireRopeError or ValueError if it fails."""
        if asked == "drag":
            # dragged back to where it was, the verdict of before is due again
            verdict = {"stale": True} if shift_of(action).any() else {"ask": {"do": "judge"}}
            yield False, {**self._preview(action), **verdict}
        elif asked == "judge":
            yield from self._verdict()
        elif asked == "save":
            self._require_files()
            files = self._documents.save()
            said = f"Saved: {', '.join(files)}, in {self._documents.folder}." if files else "Saved: nothing has changed."
            yield True, {"dirty": False, "said": said, "tone": "good"}
        elif asked in FILES:
            yield from self._written(asked)
        elif asked in SEARCHES:
            self._found |= SEARCHES[asked](str(action.get("value", "")))
            yield True, {"html": dict(self._found)}
        elif asked in ("try-parts", "stop-trial"):
            yield from self._tried(asked, action)
        else:
            said, selected = self._done(asked, action)
            yield True, {**self._placed(sliders=asked == "slide"), "said": _sentence(said), "tone": "", **selected}
            yield from self._verdict(exact=action.get("passing") is not True)

    def _done(self, asked: str, action: Entries) -> tuple[str, Message]:
        """Move a slider, undo, redo or edit; return a phrase that says what was done, and which rows are selected then."""
        loaded = self._loaded
        if asked == "slide":
            values = with_slider(loaded.sliders, loaded.values, action.get("key"), action.get("value"))
            self._loaded = replace(loaded, values=values)
            return "what-if, which no file has" if self._loaded.moved else "every slider stands as the files say", {}
        self._require_files()
        put_back = "; the sliders are back, since a file is edited without them" if loaded.moved else ""
        if asked in ("undo", "redo"):
            said = self._documents.step(-1 if asked == "undo" else 1)
            if not said:
                return f"there is nothing to {asked}", {}
            self._loaded = load(self._documents, self._documents.texts, loaded.tables)
            return f"{'Undone' if asked == 'undo' else 'Done again'}: {said}{put_back}", {}
        texts, said, selected = self._edited(asked, action)
        self._take(texts, said)
        return said + put_back, selected

    def changed_outside(self) -> Message | None:
        """Load files that other programs have changed, and return the message about it; None if there are none."""
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
        return self._documents.written / name if any(name in files for files in FILES.values()) else None

    def close(self) -> None:
        self._trial.stop()
        self._documents.close()

    def _require_files(self) -> None:
        if not self._documents.files:
            raise ModelError("a scenario or a run is shown as it is; sliders alone change it.")

    def _take(self, texts: Texts, said: str) -> None:
        """Load new texts of the files and show them; ModelError if two mounts stand in each other that did not before."""
        loaded = load(self._documents, texts, self._loaded.tables)
        before = overlapping(self._loaded.system)
        if new := [pair for pair in overlapping(loaded.system) if pair not in before]:
            raise ModelError(f"mounts {' and '.join(new[0])} would stand in each other.")
        self._documents.edit(texts, said)
        self._loaded = loaded

    def _edited(self, asked: str, action: Entries) -> tuple[Texts, str, Message]:
        """Edit tables or job; return the new texts, a phrase that says what was done, and which rows are selected then."""
        loaded = self._loaded
        if asked in TABLE_EDITS:
            if loaded.layout is None:
                raise ModelError("what stands in a model's file is not moved; a board moves what stands in tables.")
            called = str(action.get("table")), str(action.get("row"))
            table = loaded.tables.get(called[0])
            if asked == "cell" and called in self._renamed and table and called[1] not in table.rows:
                action = {**action, "row": self._renamed[called]}
            tables, said, copies = edited_tables(loaded.tables, loaded.layout, asked, action)
            if asked == "cell" and action.get("column") == "name":
                self._renamed[called] = str(action.get("value", "")).strip()
            return {"job": loaded.texts["job"], **tables}, said, {"selected": copies} if copies else {}
        if asked not in JOB_EDITS:
            raise ModelError(f"there is nothing called {asked[:40]!r} to do.")
        job, said = edited_job(loaded.texts["job"], asked, action)
        return {**loaded.texts, "job": job}, said, {}

    def _placed(self, *, sliders: bool = False) -> Message:
        """Return the message with the scene and the left column; the verdict is marked as one of earlier positions.

        With `sliders` the left column is not replaced but for its sliders.
        """
        column = "sliders" if sliders else "left"
        found = self._found | {"tried": self._trial.html(self._loaded.texts)}
        html = {column: fragment(f"{column}.html.jinja", form=form_of(self._loaded, found))}
        return {"scene": self._scene(self._loaded, {}), "dirty": self._documents.unsaved, "stale": True, "html": html}

    def _scene(self, loaded: Loaded, over: Mapping[str, float], **moved: Any) -> Message:
        """Draw a model, or what is dragged (`moved`), with utilisations of mounts, `over`, in place of the verdict's."""
        return board_scene(loaded.system, loaded.layout, {**self._verdicts.used, **over}, loaded.sag, **moved)

    def _preview(self, action: Entries) -> Message:
        """Return scene, statics and modes of the model while rows are dragged, and mounts beyond their rated static load."""
        names, by, loaded = names_of(action), shift_of(action), self._loaded
        if all(name.startswith(("mount/", "stop/")) for name in names):
            moved = replace(loaded, job=replace(loaded.job, system=_shifted(loaded, names, by)))
        else:  # on its deck, at its temperature, with its sliders
            moved = replace(load(self._documents, self._edited("move", action)[0], loaded.tables), values=loaded.values)
        mounts = {} if isinstance(moved.sag, Absent) else moved.sag.mounts
        over = {name: row.utilisation for name, row in mounts.items() if row.utilisation and row.utilisation > 1.0}
        collide = {name for pair in overlapping(moved.system) for name in pair}
        scene = self._scene(moved, over, collide=collide, names=names, by=(1e3 * by).round(6).tolist())
        return {"scene": scene, "html": {"statics": at_rest_html(moved)}}

    def _verdict(self, *, exact: bool = True) -> Iterator[tuple[bool, Message]]:
        """Judge the load cases and yield what is known of them, or why they cannot be simulated."""
        for html, changes in self._verdicts.of(self._loaded, exact=exact):
            scene = {} if html.keys() == {"compared"} else {"scene": self._scene(self._loaded, {})}
            yield True, {"html": html, **changes, **scene}

    def _tried(self, asked: str, action: Entries) -> Iterator[tuple[bool, Message | Waited]]:
        """Have other processes simulate the parts whose names match a pattern, and list them as they are done; or stop that."""
        answers = self._trial.begin(self._loaded, str(action.get("value", ""))) if asked == "try-parts" else self._trial.stop()
        for answer in answers:
            yield True, {"html": {"tried": self._trial.html(self._loaded.texts)}}
            yield False, answer
            if answer.cancelled():
                return
        said = "Parts are listed by what they use." if answers else "Stopped."
        yield True, {"html": {"tried": self._trial.html(self._loaded.texts)}, "said": said, "tone": ""}

    def _written(self, asked: str) -> Iterator[tuple[bool, Message | Waited]]:
        """Have another process write what `wirerope cases` writes of the job as it is now, and open a part of it."""
        loaded, documents, governing = self._loaded, self._documents, self._verdicts.governing
        if loaded.moved and documents.files:
            raise ModelError("sliders show what would be; set them back, since a report is of what the files say.")
        lasts = "a film takes minutes" if asked == "film" else "it takes a while"
        said = f"Computing and writing every load case as it stands: {lasts}. What is edited meanwhile is not in it."
        yield False, {"said": said, "tone": ""}
        while self._writing is not None and not self._writing.done():  # what was asked for before
            yield False, self._writing
        with TemporaryDirectory(prefix="wirerope-board-") as copies:
            scenario = loaded.job.cases[0].scenario
            system, motion = variant(loaded.job.system, scenario.motion, loaded.values)
            of: Path | Scenario = replace(scenario, motion=motion, changes=system.changes)
            if documents.files:
                documents.write_copies(loaded.texts, Path(copies))
                of = documents.copy("job", Path(copies))
            writing = self._writing = Order(asked, of, documents.written, governing).write_beside()
            yield False, writing
        path = writing.result()
        if isinstance(path, str):
            raise ModelError(path.replace(f"{copies}/", ""))
        address = f"/viewer?recording={path.name}" if asked == "timeline" else f"/files/{path.name}"
        yield False, {"open": address, "said": f"Written: {path}.", "tone": "good"}


def _shifted(loaded: Loaded, names: Sequence[str], by: Array) -> System:
    """Return the system with mounts and stops shifted by `by` [m], (3,); ModelError if the model has no room for that.

    What has no row of its own goes with its mount: the stop where that goes solid, and those of a row for several mounts.
    """
    system = loaded.job.system
    rows = {row for kind, table in loaded.tables.items() if kind in ("mounts", "stops") for row in table.rows}
    at_mounts = tuple(f"_{name.partition('/')[2]}" for name in names if name.startswith("mount/"))
    joined = [name for name in system.mounts if name not in rows and name.endswith(at_mounts)]
    return varied(system, positions=dict.fromkeys([*(name.partition("/")[2] for name in names), *joined], by))


def _reason(text: str) -> str:
    """Write why a field is refused for the window that shows the field: an example first, and no line of a file."""
    text = re.sub(r"job\.toml(, line \d+)?: (`\w+`: |\[\[?\w+\]\]? (\d+ '.*?': )?)?", "", text, count=1)
    text = re.sub(r"\b(\w+)\.csv, line \d+", r"the table of \1", text)
    text = re.sub(r": looked for \S+ and .+?\.toml\. ", ". ", text)
    kind, typed = "", ""  # which motion, limit or deck is said, and what was typed of it
    if echo := re.match(r"""([\w-]+) ["']([^"'/]*)[^"']*["']: """, text):
        (kind, typed), text = echo.groups(), text[echo.end() :]
    if examples := re.search(r" (It is written like|Expected is a phrase such as) (.+?)\.( Here it is .*)?$", text):
        said = re.findall(r'"([^"]+)"', examples[2])
        example = next((each for each in said if each.partition("/")[0] == typed), said[0])
        text = f'for example "{f"{kind} " * (kind in SPOKEN_MOTIONS)}{example}". {_sentence(text[: examples.start()])}'
    return text


def _sentence(text: str) -> str:
    """End a message as a sentence, and begin it as one unless it begins with a name."""
    first = text.split(" ", 1)[0]
    return f"{text[0].upper()}{text[1:]}{'' if text.endswith('.') else '.'}" if first.isalpha() else f"{text.rstrip('.')}."
