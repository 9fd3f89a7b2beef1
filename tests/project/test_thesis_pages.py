"""The pages about the thesis say what was computed, and what was computed can be computed again."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "docs" / "thesis"

pytestmark = pytest.mark.skipif(not FOLDER.is_dir(), reason="the pages stand in a checkout only")


@pytest.fixture(scope="module")
def pages():
    """Return what makes the pages."""
    sys.path.insert(0, str(ROOT))
    from docs.thesis import pages

    return pages


def test_every_page_has_the_numbers_that_were_computed(pages):
    numbers = pages.stored()
    assert set(numbers) == set(pages.CHAPTERS)
    for name in pages.CHAPTERS:
        text = pages.page(name).read_text(encoding="utf-8")
        assert text == pages.written(name, numbers[name]), f"run `python -m docs.thesis {name}` and commit what it writes"


def test_every_number_of_a_page_is_a_computed_one(pages):
    for name, numbers in pages.stored().items():
        shown = set(re.findall(r"\{(\w+):", (FOLDER / "templates" / f"{name}.md").read_text(encoding="utf-8")))
        assert shown <= set(numbers)
        assert len(shown) > 0.7 * len(numbers), "numbers are computed to be shown"


def test_every_picture_is_there_shown_and_small(pages):
    shown = {file for name in pages.CHAPTERS for file in re.findall(r"\]\((\S+\.(?:png|gif))\)", pages.page(name).read_text())}
    drawn = {path.name: path.stat().st_size for path in FOLDER.iterdir() if path.suffix in (".png", ".gif")}
    assert shown == set(drawn)
    assert max(drawn.values()) < 250_000


def test_index_names_every_figure_of_the_scan_and_every_appendix():
    text = (FOLDER / "index.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\S.*?) \| (\S.*?) \|", text, flags=re.MULTILINE)
    figures = {number for row, _ in rows for number in re.findall(r"\b[2-4]\.\d{1,2}\b", row)}
    assert figures >= {f"2.{i}" for i in range(1, 13)} | {f"3.{i}" for i in range(1, 23)} | {"4.1", "4.2"}
    assert {"5.x", "6.x", "7.x"} <= {row[:3] for row, _ in rows}
    assert {row[0] for row, _ in rows if re.match(r"[A-G] ", row)} == set("ABCDEFG")
    assert {f"Table 3.{i}" for i in range(1, 5)} <= {row[:9] for row, _ in rows}
    words = ("reproduced", "corrected", "answered", "lost in the scan", "sketch", "photograph")
    for row, status in rows:
        assert row in ("figure", "what") or any(word in status for word in words), (row, status)


def test_answers_hold(pages):
    n = pages.stored()["questions"]
    for case in ("plain", "modified_1", "modified_2"):  # (a): stiffness and area predict the ratio of the peaks
        assert n[f"{case}_apart"] < (0.5 if case != "modified_2" else 0.6)  # measured: 0.53 at 1 g
        assert n[f"{case}_shot"] > 1.1
        assert abs(n[f"{case}_linear"] / n[f"{case}_shot"] - 1.0) == pytest.approx(n[f"{case}_apart"] / 100.0, abs=1e-6)
    for place in (1, 2):  # (b): one set is too soft and too damped at small levels, two are nearer
        assert n[f"one_f{place}"] < n[f"two_f{place}"] < n[f"spring_f{place}"]
        assert n[f"one_t{place}"] < n[f"two_t{place}"]
    for place in range(1, 6):  # (c)
        assert n[f"ours_{place}"] == n[f"waited_{place}"] == 0.0
        assert n[f"left_{place}"] < 1.0
        assert n[f"naive_{place}_1"] > 0.0
    assert n["frame_half_sine"] < n["frame_velocity_step"]  # (d)
    assert max(n[f"tips_{place}"] for place in (1, 2, 3)) < 0.1 * abs(n["area_1"] - n["area_3"])  # (e)


@pytest.mark.slow
def test_the_pair_and_the_springs_are_computed_again(pages):
    stored = pages.stored()
    questions, four = pages.chapter("questions"), pages.chapter("chapter_4")
    for name, value in questions.pairs().items():
        assert value == pytest.approx(stored["questions"][name], rel=1e-3, abs=2e-3), name  # another processor's rounding
    for name, value in four.numbers().items():
        assert value == pytest.approx(stored["chapter_4"][name], rel=1e-6), name


@pytest.mark.slow
def test_the_shaker_and_its_motions_are_computed_again(pages):
    stored, chapter = pages.stored()["chapter_7"], pages.chapter("chapter_7")
    for place, frequency in enumerate(chapter.AT, 1):
        assert chapter.amplitude(chapter.orbit(frequency)) == pytest.approx(stored[f"a{place}"], rel=1e-4)
