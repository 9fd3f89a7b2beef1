"""A name in a model, a file or a folder is text in every output, and a folder is data: nothing in it is executed."""

import io
import re
import shutil
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
from hostile_names import (
    BLOCK,
    BREAK,
    DEVICE,
    ESCAPE,
    FILE_NAME,
    MOUNT,
    NAME,
    TITLE,
    write_hostile_model,
    write_hostile_scenario,
)  # fmt: skip
from markdown_it import MarkdownIt
from rig_records import rig_record, write_record

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.engine.from_tables import read_layout
from wirerope_mj.engine.system.model_files import write_model
from wirerope_mj.foundation.errors import ModelError
from wirerope_mj.foundation.plain_text import markdown, markdown_lines, plain, plain_lines
from wirerope_mj.foundation.resources import models_folder
from wirerope_mj.runs.new_model import tables_in
from wirerope_mj.views import terminal as screen
from wirerope_mj.views.plots.model_plan import save_plan


def printed(*arguments, code=0) -> str:
    """Return what a command prints on both streams, on a screen so wide that no name is cut."""
    stream = io.StringIO()
    with redirect_stdout(stream), redirect_stderr(stream):
        assert main([str(argument) for argument in arguments]) == code, stream.getvalue()
    return stream.getvalue()


@pytest.fixture(scope="module", autouse=True)
def wide():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(screen, "WIDTH", 800)
        yield


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Return the folder of model, isolator and scenario."""
    folder = tmp_path_factory.mktemp("hostile") / "deep" / "deeper"
    folder.mkdir(parents=True)
    write_hostile_model(folder)
    return folder


@pytest.fixture(scope="module")
def run(place):
    """Return the folder of a run in which every name is hostile, and what the command printed."""
    scenario = write_hostile_scenario(place)
    folder = place / f"run{FILE_NAME}{ESCAPE}"
    return folder, printed("run", scenario, "--out", folder)


@pytest.fixture(scope="module")
def study(place, run):
    """Return the folder of a study in which every name is hostile, and what the command printed."""
    folder = place / f"study{FILE_NAME}{ESCAPE}"
    scenario = next(place.glob("*.py"))
    vary = ("--vary", "body/block*/mass = Uniform(0.9, 1.1, relative)", "--variants", 4, "--workers", 1)
    return folder, printed("study", scenario, *vary, "--out", folder)


@pytest.fixture
def copy(run, tmp_path):
    """Return a copy of the run that a test may change, below a folder in which it must not read."""
    return Path(shutil.copytree(run[0], tmp_path / "outside" / "copy"))


def test_invisible_characters_are_spelled_out():
    assert plain(f"{ESCAPE}{TITLE}{BREAK}\u202e\x9b\udcff") == r"\x1b[31mred\x1b]0;owned\x07first\nsecond\u202e\x9b\udcff"
    assert plain_lines(f"{BREAK}\x1b") == "first\nsecond\\x1b"
    assert plain("deck é 15\u202fg\t±½ 振動") == "deck é 15\u202fg\t±½ 振動"  # what can be seen stays


@pytest.mark.parametrize(
    "text",
    [NAME, "![x](http://a.b/c.png)", "[x](http://a.b)", "<http://a.b>", "*a* _b_ __c__ ~~d~~ `e`", "# a", "- a", "1. a", "2) a",
     "> a", "a\\|b", "&lt;", "===", "---", "+ a", "http_server_1", "    code", "|a|b|", "\\", "$x$", "![", "*", "***"],
)  # fmt: skip
def test_markdown_of_a_text_shows_that_text(text):
    page = MarkdownIt("commonmark").enable(["table", "strikethrough"])
    shown = page.render(f"{markdown(text)}\n\n| a | b |\n|---|---|\n| {markdown(text)} | c |\n- {markdown(text)}")
    seen = Page(shown)
    assert set(seen.tags) <= {"p", "table", "thead", "tbody", "tr", "th", "td", "ul", "li"}
    assert [cell.strip() for cell in seen.texts].count(text.strip()) == 3, shown


def test_markdown_keeps_paragraphs_and_escapes_their_lines():
    assert markdown_lines("a\n\n# b") == "a\n\n\\# b"


class Page(HTMLParser):
    """Tags, attributes and texts of a page."""

    def __init__(self, html):
        super().__init__()
        self.tags, self.attributes, self.texts = [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, name, value) for name, value in attrs]

    def handle_data(self, data):
        self.texts.append(data)


def check_page(path) -> str:
    """Return the visible text of a report after a look at its elements and pictures."""
    html = path.read_text(encoding="utf-8")
    page = Page(html)
    assert not set(page.tags) & {"iframe", "object", "red"}
    assert page.tags.count("script") == 1  # the page's own, named by its digest: no other may run
    links = [value for tag, name, value in page.attributes if (tag, name) == ("a", "href")]
    assert {link[1:] for link in links} <= {value for _, name, value in page.attributes if name == "id"}
    assert {name for _, name, _ in page.attributes if name.startswith("on")} == set()
    pictures = [value for tag, name, value in page.attributes if (tag, name) == ("img", "src")]
    drawings = re.findall(r"<svg.*?</svg>", html, re.DOTALL)
    assert drawings
    assert not pictures
    for drawing in drawings:
        ElementTree.fromstring(drawing)  # well-formed, or another reader of the page shows nothing
    assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", html)
    return "\n".join(page.texts)


def test_the_page_of_a_run_shows_names_as_text(run):
    text = check_page(run[0] / "report.html")
    for name in (BLOCK, MOUNT, DEVICE):
        assert name in text
    assert plain(f"made up {NAME}{ESCAPE}{TITLE}") in text
    assert plain(f"Does [click](http://example.com) {NAME}{ESCAPE}") in text


def test_the_page_of_an_identification_shows_names_as_text(place):
    law = wr.EnhancedDryFriction(k=5e4, d=800.0, u_c=2e-3)
    record = write_record(place / f"{FILE_NAME}.csv", *rig_record(law, [1e-3, 4e-3]))
    out, folder = place / "identified.toml", place / f"fit{FILE_NAME}{ESCAPE}"
    options = ("--law", "enhanced-dry-friction", "--out", out, "--report", folder, "--name", NAME)
    shown = printed("identify", record, *options)
    text = check_page(folder / "report.html")
    for name in (NAME, FILE_NAME):
        assert name in shown
        assert name in text
    assert plain(str(folder)) in shown


def test_the_page_of_a_study_shows_names_as_text(study):
    printed("study-report", study[0])
    text = check_page(study[0] / "report.html")
    for name in (FILE_NAME, plain(NAME + ESCAPE), "body/block*/mass"):
        assert name in text, text


@contextmanager
def raised_warnings():
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def terminal_outputs(place, run, study):
    """Yield the names of commands, what they print of these names, and the names that must be in it."""
    folder, text = run
    yield "run", text, (BLOCK, MOUNT, plain(str(folder)), FILE_NAME)
    yield "study", study[1], (plain(str(study[0])), FILE_NAME)
    yield "report", printed("report", folder, "--out", place / f"{ESCAPE}.html"), (plain(f"{ESCAPE}.html"),)
    yield "replay", printed("replay", folder), (plain(str(folder)), "bit-identical")
    other = place / "other"
    shutil.copytree(folder, other)
    options = ("--out", place / f"{ESCAPE}.rrd")
    yield (
        "compare",
        printed("compare", folder, other, *options, "--all"),
        (BLOCK, MOUNT, plain(folder.name), plain(options[1].name)),
    )
    names = ("--names", NAME, "[bold]b")
    yield "names", printed("compare", folder, other, *options, "--force", *names), (NAME, "[bold]b")
    yield "statics", printed("statics", place / "model.xml"), (BLOCK, MOUNT)
    yield "modes", printed("modes", place / "model.xml", "--out", place / f"modes{ESCAPE}"), (plain(f"modes{ESCAPE}"),)
    source = plain(f"made up {NAME}{ESCAPE}{TITLE}")
    yield "isolators", printed("isolators", place / "device.toml", "--out", place / f"{ESCAPE}.png"), (DEVICE, source)
    yield "loops", printed("loops", place / "device.toml", "--out", place / f"{ESCAPE}.svg"), (DEVICE,)
    yield "error", printed("report", place / f"none{ESCAPE}", code=2), (plain(f"none{ESCAPE}"),)
    yield "option", printed("report", f"--{ESCAPE}", code=2), (plain(ESCAPE),)


def test_the_terminal_shows_names_as_text(place, run, study):
    with raised_warnings():
        for command, text, names in terminal_outputs(place, run, study):
            assert not re.search(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]", text), command
            for name in names:
                assert name in text, (command, name, text)
    ElementTree.parse(place / f"{ESCAPE}.svg")


def test_a_terminal_is_coloured_by_us_alone(monkeypatch):
    shown = screen._Screen(force_terminal=True, width=80, file=io.StringIO(), highlight=False, emoji=False)
    shown.print(f"[bold]ours[/] {ESCAPE}{TITLE} :warning:")
    text = shown.file.getvalue()
    assert "\x1b[1mours\x1b[0m" in text
    assert r"\x1b[31mred\x1b]0;owned\x07 :warning:" in text
    assert text.count("\x1b") == 2


def documents(path) -> dict[str, str]:
    """Return the texts of a recording by entity."""
    from rerun.chunk import RrdReader

    found = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        if "TextDocument:text" in batch.schema.names:
            found[str(chunk.entity_path)] = "\n\n".join(text[0] for text in batch["TextDocument:text"].to_pylist() if text)
    return found


def test_the_texts_of_recordings_show_names_as_text(place, run, study):
    terminal = place / "compared.rrd"
    printed("compare", run[0], run[0], "--out", terminal, "--names", NAME, "b|c")
    printed("modes", place / "model.xml", "--out", place / "recorded")
    texts = {}
    for path in (run[0] / "run.rrd", terminal, place / "recorded" / "run.rrd"):
        texts |= {f"{path.name}{entity}": text for entity, text in documents(path).items()}
    assert len(texts) >= 6
    for name, text in texts.items():
        page = Page(MarkdownIt("commonmark").enable(["table", "strikethrough"]).render(text))
        assert not set(page.tags) & {"img", "a", "code", "h1"}, (name, text)
        assert "\x1b" not in text
    seen = "\n".join(Page(MarkdownIt("commonmark").enable("table").render("\n\n".join(texts.values()))).texts)
    for name in (BLOCK, MOUNT, NAME, "b|c", plain(f"{NAME}{ESCAPE}"), "[click](http://example.com)", "# hold?"):
        assert name in seen, name


def test_a_block_of_toml_ends_where_its_text_does(run):
    from wirerope_mj.content.judged_run import RunResult
    from wirerope_mj.views.recording.drawn_runs import run_texts

    text = f'a = """\n```\n![x](http://a.b/c.png){ESCAPE}\n"""'.replace("\x1b", "")
    texts = run_texts(RunResult(response=wr.load_response(run[0]), verdicts=()), title=NAME, scenario_text=text)
    shown = MarkdownIt("commonmark").render(next(one.text for one in texts if one.name == "Scenario"))
    assert "<img" not in shown
    assert "![x](http://a.b/c.png)" in shown


def test_entities_of_a_recording_are_named_as_they_are(run):
    """A name with slashes is one part of a path, so that no entity lands beside another one."""
    from rerun.chunk import RrdReader

    from wirerope_mj.views.recording.paths import entity

    paths = {str(chunk.entity_path) for chunk in RrdReader(str(run[0] / "run.rrd")).stream()}
    wanted = entity(BLOCK)
    assert any(wanted in path for path in paths), sorted(paths)
    assert not any("/../" in path for path in paths)


def test_a_plan_shows_formulas_and_escapes_as_letters(tmp_path):
    layout = read_layout("genset", tables_in(models_folder() / "templates" / "genset"))
    mounts = (replace(layout.mounts[0], name=f"$x^2$ {ESCAPE} 振"), *layout.mounts[1:])
    layout = replace(layout, name=f"{NAME} $\\alpha$ \\$", mounts=mounts)
    with raised_warnings():
        for ending in ("svg", "png", "pdf"):
            save_plan(layout, tmp_path / f"a.{ending}")
    svg = (tmp_path / "a.svg").read_text(encoding="utf-8")
    ElementTree.fromstring(svg)
    drawn = unescape(svg)
    assert f"{NAME} $\\alpha$ \\$: " in drawn
    assert f"$x^2$ {plain(ESCAPE)} 振" in drawn


def test_files_are_written_where_they_were_asked_for_alone(place, run, study):
    before = {path.name for path in place.parent.parent.iterdir()}
    assert before == {"deep"}
    assert {path.name for path in place.parent.iterdir()} == {"deeper"}
    model = run[0] / "model"
    stop = {"isolators", "isolators/bump_stop_1mn.toml"}
    assert {str(path.relative_to(model)) for path in model.rglob("*")} == {"model.xml", "device.toml"} | stop


def test_an_isolator_above_the_model_is_copied_into_the_run(place, tmp_path):
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    text = (place / "model.xml").read_text(encoding="utf-8").replace('"device.toml"', '"../../x"')
    (folder / "model.xml").write_text(text, encoding="utf-8")
    shutil.copy(place / "device.toml", tmp_path / "x.toml")
    written = write_model(wr.load_system(folder / "model.xml"), folder / "copy")
    assert 'data="isolators/x"' in written.read_text(encoding="utf-8")
    assert (folder / "copy" / "isolators" / "x.toml").is_file()


@pytest.mark.parametrize("bad", [BREAK, ESCAPE, "\u202eevil"])
def test_names_that_cannot_be_seen_are_refused(place, bad):
    text = (place / "model.xml").read_text(encoding="utf-8")
    text = text.replace('joint name="block_x"', f'joint name="{bad.replace(chr(10), "&#10;")}"')
    with pytest.raises(ModelError, match="holds characters that cannot be seen") as raised:
        wr.load_system(text, isolators={NAME.replace(" ", ""): wr.load_isolator(place / "device.toml")})
    assert repr(bad) in str(raised.value)
    device = wr.load_isolator(place / "device.toml")
    with pytest.raises(ValueError, match="`name` must be one line of visible characters"):
        wr.Isolator(name=bad, axial=device.axial)
    assert "`--names` must be visible characters" in printed("compare", "a", "b", "--names", "a", bad, code=2)
