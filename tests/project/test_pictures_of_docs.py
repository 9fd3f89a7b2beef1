"""The pictures of the docs show what the program says today; `python docs/build_pictures.py` builds them."""

import hashlib
import os
import re

import pytest

from wirerope_mj.foundation.resources import models_folder

ROOT = models_folder().parent
DOCS = ROOT / "docs"

pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="the docs stand in a checkout only")


@pytest.fixture(scope="module")
def pictures():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(DOCS))
        import build_pictures

        yield build_pictures


def test_every_picture_is_the_one_that_was_built_and_stands_in_a_page(pictures):
    files = {path.stem: hashlib.sha256(path.read_bytes()).hexdigest() for path in (DOCS / "img").glob("*.png")}
    assert files == {name: entry["sha256"] for name, entry in pictures.kept().items()}
    assert set(files) == set(pictures.PICTURES)
    pages = [*DOCS.glob("*.md"), ROOT / "README.md", ROOT / "paper" / "paper.md"]
    shown = {name for page in pages for name in re.findall(r"img/(\w+)[.]png", page.read_text(encoding="utf-8"))}
    assert shown == set(files)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "floating_floor",
        "first_run",
        "board",
        "compare",
        "damage_spectra",
        "first_model",
        "frequency_response",
        "frequency_response_view",
    ],
)
def test_a_picture_shows_what_the_program_says_today(name, pictures, here, monkeypatch):
    monkeypatch.delenv("RERUN", raising=False)
    monkeypatch.setenv("COLUMNS", os.environ.get("COLUMNS", "120"))  # which the script sets
    assert pictures.PICTURES[name]().shows == pictures.kept()[name]["shows"], (
        f"docs/img/{name}.png is older than what it shows: run `python docs/build_pictures.py {name}`, and look at it"
    )


def test_those_that_are_not_made_anew_by_a_test_are_said_to_take_long(pictures):
    assert set(pictures.LONG) == {"placement_front", "placement_plans"}
