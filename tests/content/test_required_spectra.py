"""Required and achieved spectra in every output of a run and of a job."""

import json

import pytest
from docx import Document
from recordings import column, entities

from wirerope_mj.cli import main

RRS = "frequency [Hz],acceleration [g]\n4,1\n8,1\n16,0.6\n"
PHRASE = "rrs.csv 6 s z damping 5 % seed 1"


@pytest.fixture
def beside_rrs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rrs.csv").write_text(RRS, encoding="utf-8")


def shocked(capsys, option, phrase=PHRASE):
    assert main(["shock", "shock_table", option, phrase, "--out", "run", "--force", "--accuracy", "1e-3", "--all"]) == 0
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.usefixtures("beside_rrs")
def test_terminal_summary_page_and_recording_have_required_and_achieved_spectrum(tmp_path, capsys):
    text = shocked(capsys, "--required-spectrum")
    assert "envelops the required spectrum from 4 to 16 Hz: lowest ratio 1.00" in text
    assert "Required and achieved response spectra of the base" in text
    content = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))["content"]
    lowest, required = content["required-spectrum"]["values"]["lowest_ratio"], content["required-spectra"]
    assert 0.99 <= lowest < 1.01
    peak = content["required-spectrum"]["values"]["lowest_peak_ratio"]
    assert peak < 0.99  # the spectrum ends on a slope
    said = f"its zero-period acceleration, the last level, is not reached: the base's peak is only {peak:.2f} along z of it"
    assert said in text
    row = dict(zip([column["heading"] for column in required["columns"]], required["rows"][0], strict=True))
    assert row["along"] == "z"
    assert row["ZPA required"] == pytest.approx(0.6 * 9.80665)
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert "achieved / required" in page
    assert "The base is driven steadily" not in page  # an earthquake has a response spectrum
    recorded = entities(tmp_path / "run" / "run.rrd")
    assert "envelops the required spectrum" in column(recorded["/peaks"], "TextDocument:text").to_pylist()[0][0]
    assert any(path.endswith("required") and path.startswith("/frequencies") for path in recorded)


@pytest.mark.slow
@pytest.mark.usefixtures("beside_rrs")
def test_a_spectrum_that_ends_level_is_enveloped_with_its_zero_period_acceleration(tmp_path, capsys):
    (tmp_path / "rrs.csv").write_text("frequency [Hz],acceleration [g]\n4,1\n8,1\n20,0.5\n50,0.5\n", encoding="utf-8")
    text = shocked(capsys, "--required-spectrum")
    assert "envelops the required spectrum: lowest ratio" in text
    assert "the base's peak is only" not in text
    content = json.loads((tmp_path / "run" / "summary.json").read_text(encoding="utf-8"))["content"]
    assert content["required-spectrum"]["values"]["lowest_peak_ratio"] >= 0.99


@pytest.mark.usefixtures("beside_rrs")
def test_a_spectrum_that_is_not_enveloped_is_said_so(capsys):
    text = shocked(capsys, "--spectrum")
    assert "falls below the required spectrum, to 0." in text
    assert "`required-spectrum` in place of `spectrum`" in text


@pytest.mark.slow
@pytest.mark.usefixtures("beside_rrs")
def test_the_document_of_a_job_shows_them_once(tmp_path, capsys):
    cases = (
        f'[[case]]\nname = "earthquake"\nrequired-spectrum = "{PHRASE}"\n[[case]]\nname = "drop"\nhalf-sine = "5 g 11 ms z"\n'
    )
    (tmp_path / "job.toml").write_text(f'model = "shock_table"\n[simulate]\naccuracy = 1e-3\n{cases}', encoding="utf-8")
    assert main(["cases", "job.toml", "--out", "job", "--docx", "--workers", "1", "--all"]) == 0
    out = capsys.readouterr().out
    assert "earthquake: The base's motion envelops the required spectrum" in out
    assert "Required and achieved response spectra of the base" in out
    document = Document(tmp_path / "job" / "report.docx")
    texts = [paragraph.text for paragraph in document.paragraphs]
    assert texts.count("Required and achieved response spectra of the base") == 1
    (number,) = [number for number, text in enumerate(texts) if text.startswith("earthquake. Required response spectrum")]
    assert document.paragraphs[number - 1]._p.xpath(".//pic:pic")  # its chart stands above the caption
