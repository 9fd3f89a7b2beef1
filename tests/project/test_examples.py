"""The examples run as they stand, assert their numbers, and end with one picture whose axes have units."""

import ast
import re
import runpy

import matplotlib
import matplotlib.pyplot as plt
import pytest

from wirerope_mj.foundation.resources import models_folder

FOLDER = models_folder().parent / "examples"
EXAMPLES = sorted(FOLDER.glob("*.py"))
SLOW = {"23_jump_and_stability", "30_tolerance_study", "41_how_stiff_a_deck"}
"""Those that may take more than 5 s."""

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="examples stand in a checkout only")


@pytest.fixture
def shown(monkeypatch):
    """Return the list of figures that a script shows; nothing opens a window."""
    matplotlib.use("Agg")
    plt.close("all")
    figures = []
    monkeypatch.setattr(plt, "show", lambda: figures.extend(map(plt.figure, plt.get_fignums())))
    yield figures
    plt.close("all")


@pytest.mark.parametrize("path", [pytest.param(p, id=p.stem, marks=[pytest.mark.slow] * (p.stem in SLOW)) for p in EXAMPLES])
def test_an_example_runs_and_shows_one_picture_whose_axes_have_units(path, shown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # what an example writes goes into a temporary folder of its own
    runpy.run_path(str(path), run_name="__main__")
    assert not list(tmp_path.iterdir())
    assert len(shown) == 1
    shown[0].canvas.draw()
    for axes in shown[0].axes:
        for label in (axes.xaxis.label, axes.yaxis.label):
            assert re.search(r"\[[^\]]+\]$", label.get_text()), f"the axis {label.get_text()!r} says no unit"
            box, page = label.get_window_extent(), shown[0].bbox
            assert page.x0 <= box.x0 < box.x1 <= page.x1, f"the label {label.get_text()!r} is cut off"
            assert page.y0 <= box.y0 < box.y1 <= page.y1, f"the label {label.get_text()!r} is cut off"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_is_short_asserts_and_uses_the_front_door(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 60
    tree = ast.parse(text)
    title, rule = ast.get_docstring(tree).splitlines()[:2]
    assert set(rule) == {"="}
    assert len(rule) == len(title)
    assert text.count("\n# %%\n# ") >= 2, "text stands between the blocks"
    assert not [line for line in _unmarked(text) if set(line) & set("|*`")], "reStructuredText reads these as markup"
    assert text.endswith("plt.show()\n")
    assert "savefig" not in text
    assert any(isinstance(node, ast.Assert) for node in ast.walk(tree))
    froms = [node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    names = [alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names]
    assert "wirerope_mj" in names
    assert not any(name.startswith("wirerope_mj") for name in froms)


def _unmarked(text):
    """Return the text between the blocks without what is marked as formula or code."""
    cells = re.findall(r"^# %%\n((?:# .*\n)+)", text, flags=re.MULTILINE)
    return [re.sub(r":math:`[^`]*`|``[^`]*``", "", cell.replace("\n# ", " ")) for cell in cells]


def test_there_are_thirty_examples():
    assert len(EXAMPLES) >= 30
