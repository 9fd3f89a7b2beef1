"""A run or a study from somebody else is data: nothing in its folder is executed, and nothing outside it is read."""

import shutil
import sys
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import wirerope_mj as wr
from wirerope_mj.cli import main
from wirerope_mj.foundation.errors import RecordError
from wirerope_mj.runs import replay
from wirerope_mj.runs.report import write_report
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.studies import load_study
from wirerope_mj.views.recording import viewer

pytestmark = pytest.mark.filterwarnings("ignore:the given step of")  # what is asked here holds at coarse steps

CODE = "from pathlib import Path\nPath(__file__).with_name('executed').touch()\n"
WORKS = {"exec", "import", "pickle.find_class", "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn"}
"""Audit events of the interpreter by which a file could become code or a process."""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("colleague") / "run"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.06), folder)
    return folder


@pytest.fixture
def copy(run, tmp_path):
    """Return a copy of the run that a test may change, in a folder of its own."""
    return Path(shutil.copytree(run, tmp_path / "inbox" / "run"))


class Audit:
    """What the interpreter does while the block runs; a hook cannot be taken away, so that it is switched off."""

    def __init__(self):
        self.on, self.events = False, []
        sys.addaudithook(self.hook)

    def hook(self, event, arguments):
        if self.on and event in WORKS:
            self.events.append((event, [getattr(a, "co_filename", a) for a in arguments]))

    def __enter__(self):
        self.on, self.events = True, []
        return self

    def __exit__(self, *_):
        self.on = False


AUDIT = Audit()


@pytest.mark.slow
def test_commands_execute_nothing_of_a_folder(copy, tmp_path, monkeypatch):
    """The folder holds whatever Python would pick up by itself: modules of common names, a scenario, a pickle."""
    names = ("scenario", "study", "sitecustomize", "numpy", "mujoco", "tomllib", "conftest", "__init__", "__main__")
    for folder in (copy, copy / "model"):
        for name in names:
            (folder / f"{name}.py").write_text(CODE, encoding="utf-8")
        (folder / "state.pkl").write_bytes(b"cposix\nsystem\n(S'touch executed'\ntR.")
    opened = []
    monkeypatch.setattr(viewer, "has_display", lambda: True)
    monkeypatch.setattr(viewer, "_run_viewer", lambda command, _: opened.append(command))
    monkeypatch.chdir(copy)
    with AUDIT, redirect_stdout(StringIO()) as screen, redirect_stderr(screen):
        for command in (
            ["show", "."],
            ["report", "."],
            ["replay", "."],
            ["compare", ".", str(copy), "--out", str(tmp_path / "c.rrd")],
        ):
            assert main(command) == 0, screen.getvalue()
    assert list(tmp_path.rglob("executed")) == []
    command = opened[0]
    assert command[-1] == "run.rrd"  # one argument of the viewer that rerun brought along, no shell
    assert command[0] == str(viewer.viewer_binary())
    of_folder = [
        (event, arguments)
        for event, arguments in AUDIT.events
        if event not in ("import", "exec") or any(str(copy) in str(argument) for argument in arguments)
    ]
    assert of_folder == []


def edited(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


OUTSIDE = {
    "isolator": ('data="isolators/enidine_wr12_400.toml"', 'data="../../../secret"'),
    "isolator, absolute": ('data="isolators/enidine_wr12_400.toml"', 'data="{secret}"'),
    "include": ("<worldbody>", '<include file="../../../secret.xml"/><worldbody>'),
    "include, absolute": ("<worldbody>", '<include file="{secret}.xml"/><worldbody>'),
    "mesh": ("<worldbody>", '<asset><mesh name="m" file="../../../secret.obj"/></asset><worldbody>'),
    "mesh by folder": (
        "<worldbody>",
        '<compiler meshdir="../../.."/><asset><mesh name="m" file="secret.obj"/></asset><worldbody>',
    ),
    "texture": (
        "<worldbody>",
        '<asset><texture name="t" type="2d" file="../../../secret.png"/></asset><worldbody>',
    ),
    "model to attach": ("<worldbody>", '<asset><model name="o" file="../../../secret.xml"/></asset><worldbody>'),
}


@pytest.mark.filterwarnings("ignore:.*Since the run was written. altered model/shock_table.xml")  # the report says so first
@pytest.mark.parametrize("what", OUTSIDE)
@pytest.mark.parametrize("use", [replay, write_report])
def test_a_model_that_names_a_file_outside_the_folder_is_not_loaded(what, use, run, copy, tmp_path, monkeypatch):
    for ending in ("toml", "xml", "obj", "png"):
        (tmp_path / f"secret.{ending}").write_text("secret", encoding="utf-8")
    shutil.copy(copy / "model" / "isolators" / "enidine_wr12_400.toml", tmp_path / "secret.toml")
    old, new = OUTSIDE[what]
    edited(copy / "model" / "shock_table.xml", old, new.format(secret=tmp_path / "secret"))
    loaded = []
    monkeypatch.setattr("wirerope_mj.runs.scenario_file.load_system", loaded.append)
    with pytest.raises(RecordError, match=r"shock_table\.xml names '.*secret.*', which lies outside this folder") as raised:
        use(copy)
    assert str(copy) in str(raised.value)
    assert loaded == []


def test_a_file_that_includes_one_outside_is_found_out_too(copy, tmp_path):
    (tmp_path / "secret.txt").write_text("<mujoco/>", encoding="utf-8")
    (copy / "model" / "more.txt").write_text('<mujoco><include file="../../../secret.txt"/></mujoco>', encoding="utf-8")
    edited(copy / "model" / "shock_table.xml", "<worldbody>", '<include file="more.txt"/><worldbody>')
    with pytest.raises(RecordError, match="'../../../secret.txt', which lies outside this folder"):
        replay(copy)


def test_a_link_out_of_the_folder_is_not_followed(copy, tmp_path):
    device = copy / "model" / "isolators" / "enidine_wr12_400.toml"
    device.rename(tmp_path / "secret.toml")
    device.symlink_to(tmp_path / "secret.toml")
    with pytest.raises(RecordError, match="which lies outside this folder"):
        replay(copy)


def test_a_model_file_outside_is_not_read(copy, tmp_path):
    shutil.copy(copy / "model" / "shock_table.xml", tmp_path / "secret.xml")
    edited(copy / "scenario.toml", 'file = "model/shock_table.xml"', 'file = "../../secret.xml"')
    with pytest.raises(RecordError, match=r"the model file '\.\./\.\./secret\.xml' is not in this folder"):
        replay(copy)


def test_a_model_that_includes_itself_is_refused_in_words(copy):
    edited(copy / "model" / "shock_table.xml", "<worldbody>", '<include file="shock_table.xml"/><worldbody>')
    with redirect_stderr(StringIO()) as screen:
        assert main(["replay", str(copy)]) == 2
    assert "shock_table.xml" in screen.getvalue()


def test_xml_that_mujoco_reads_leniently_is_refused_with_its_line(copy):
    model = copy / "model" / "shock_table.xml"
    edited(model, '<body name="block"', '<body name="block & tackle"')
    line = 1 + model.read_text(encoding="utf-8").partition("block & tackle")[0].count("\n")
    with redirect_stderr(StringIO()) as screen:
        assert main(["replay", str(copy)]) == 2
    assert f"shock_table.xml, line {line}, column" in screen.getvalue()
    assert "Write & as &amp;" in screen.getvalue()


def test_a_study_reads_nothing_outside_its_folder_either(tmp_path):
    from table_study import table_study

    folder = tmp_path / "study"
    table_study(variants=4).run(folder, workers=1)
    (tmp_path / "secret.xml").write_text("<mujoco/>", encoding="utf-8")
    edited(folder / "study.toml", 'file = "model/shock_table.xml"', 'file = "../secret.xml"')
    import tomllib

    from wirerope_mj.studies.inputs_file import identity

    content = tomllib.loads((folder / "study.toml").read_text(encoding="utf-8"))
    edited(folder / "study.toml", content["id"], identity(content))
    with pytest.raises(RecordError, match=r"the model file '\.\./secret\.xml' is not in this folder"):
        load_study(folder).response(0)
