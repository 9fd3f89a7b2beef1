"""Names in any script: pictures take letters from the fonts of the machine, and what no font has is named."""

import warnings

import numpy as np
import pytest
from shown import pages_of

from wirerope_mj.cli import main
from wirerope_mj.content.blocks import Chart, Content, Curve, Panel, Section, Statement
from wirerope_mj.foundation.errors import FontWarning
from wirerope_mj.views.document import write_pdf
from wirerope_mj.views.pictures import save_pictures
from wirerope_mj.views.plots import letters

KOREAN, CHINESE = "제진대_1", "配电盘"
NOWHERE = "\N{EGYPTIAN HIEROGLYPH A001}x"
"""A name that no font here is expected to have; where one has, the test of what is said does not hold and is skipped."""


def chart(name):
    x = np.linspace(0.0, 1.0, 5)
    return Chart(rows=[[Panel(curves=[Curve(x=x, y=x, name=name, kind=0)], ylabel="travel [mm]")]])


@pytest.fixture
def no_fonts(monkeypatch):
    """A machine that has the package's fonts alone."""
    monkeypatch.setattr(letters, "_system_fonts", lambda: [])


def has_font_of(text):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        files = letters.fonts_for(text)
    return len(files) > len(letters.BROUGHT) and not said


def test_a_picture_names_what_no_font_has(no_fonts, tmp_path):
    with pytest.warns(FontWarning, match=rf'letters of "{KOREAN}", "{CHINESE}": boxes stand in their place'):
        save_pictures([chart(CHINESE)], tmp_path / "a.png", title=f"{KOREAN} on two mounts")


def test_a_picture_of_common_letters_opens_no_font_and_says_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr(letters, "_system_fonts", lambda: pytest.fail("fonts were looked for"))
    save_pictures([chart("Gehäuse Ω, αβγ, ЖЩ: 3 − 2 ≈ 1 … µm²")], tmp_path / "a.png")


def test_a_picture_takes_letters_from_the_fonts_of_the_machine(tmp_path):
    if not has_font_of(CHINESE):
        pytest.skip("no font here has Chinese letters")
    for name in (CHINESE, "配电"):
        save_pictures([chart(name)], tmp_path / f"{len(name)}.png")
    assert (tmp_path / "3.png").read_bytes() != (tmp_path / "2.png").read_bytes()


@pytest.mark.parametrize("fonts", ["all", "none"])
def test_a_plan_of_a_model_draws_them_or_says_so(fonts, here, capsys, monkeypatch):
    if fonts == "all" and not (has_font_of(KOREAN) and has_font_of(CHINESE)):
        pytest.skip("no font here has Korean and Chinese letters")
    if fonts == "none":
        monkeypatch.setattr(letters, "_system_fonts", lambda: [])
    mounts = ["name, x [mm], y [mm], z [mm], isolator"]
    mounts += [
        f"{KOREAN}{n}, {x}, {y}, 45, enidine_wr12_400" for n, (x, y) in enumerate([(0, 0), (400, 0), (0, 400), (400, 400)])
    ]
    (here / "m.csv").write_text("\n".join(mounts), encoding="utf-8")
    columns = "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]"
    (here / "k.csv").write_text(f"{columns}\n{CHINESE}, 100, 200, 200, 300, 400, 400, 500\n", encoding="utf-8")
    assert main(["new", "out", "--mounts", "m.csv", "--masses", "k.csv", "--pdf"]) == 0
    said = capsys.readouterr().err
    assert ("no font of this machine has the letters of" in said) == (fonts == "none"), said
    if fonts == "none":
        assert CHINESE in said
        assert KOREAN[:3] in said


@pytest.mark.parametrize("fonts", ["all", "none"])
def test_a_pdf_sets_letters_of_any_script_or_names_what_no_font_has(fonts, here, monkeypatch):
    pytest.importorskip("typst")
    if fonts == "all" and not (has_font_of(KOREAN) and has_font_of(CHINESE)):
        pytest.skip("no font here has Korean and Chinese letters")
    section = Section("a", "A", lambda: [Statement(text=f"The cabinet {CHINESE} 2"), chart(f"<{KOREAN}>")])
    content = Content(title="Letters", question=("?",), verdict=Statement(), sections=(section,))
    if fonts == "none":
        monkeypatch.setattr(letters, "_system_fonts", lambda: [])
        with pytest.warns(FontWarning, match=rf'letters of "{CHINESE}", "<{KOREAN}>": boxes'):
            write_pdf(content, here / "a.pdf")
    else:
        write_pdf(content, here / "a.pdf")
    (page,) = pages_of(here / "a.pdf")
    assert "The cabinet" in page
    assert (f"The cabinet {CHINESE} 2" in page and f"<{KOREAN}>" in page) == (fonts == "all")


def test_a_letter_that_no_font_has_is_said_by_the_command_once(here, capsys):
    if has_font_of(NOWHERE):
        pytest.skip("a font here has hieroglyphs")
    isolator = '[axial]\nlaw = "kelvin-voigt"\nk = 1e5\nc = 10.0\n'
    (here / "a.toml").write_text(f'name = "{NOWHERE}"\n{isolator}', encoding="utf-8")
    assert main(["loops", "a.toml", "--amplitudes", "1", "--out", "a.png"]) == 0
    assert capsys.readouterr().err.count(NOWHERE) == 1
