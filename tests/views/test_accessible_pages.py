"""Pages of the documentation site and of results: no serious finding of axe-core, no code that is cut."""

import subprocess
import sys
import warnings
from contextlib import chdir
from importlib.util import find_spec

import pytest
from browsers import launched, no_browser, opened
from writing_commands import WRITING, prepare

from wirerope_mj.cli import main
from wirerope_mj.foundation.resources import models_folder

DOCS = models_folder().parent / "docs"
pytestmark = [pytest.mark.browser, pytest.mark.slow]

SITE = ("index", "start", "shock", "verification", "api/engine")
RESULTS = {  # pages by the commands that write them
    "shock": "run/report.html", "cases": "job/report.html", "study-report": "s.html", "compare": "compared/report.html",
    "identify": "identified-report/report.html",
}  # fmt: skip
NEEDED = ("shock", "run", "study", "study-report", "cases", "compare", "identify")  # each after what it reads
CUT = """() => [...document.querySelectorAll("pre")].filter(code => {
    if (!code.clientWidth || code.scrollWidth <= code.clientWidth + 1) return false;
    const scrolls = element => ["auto", "scroll"].includes(getComputedStyle(element).overflowX);
    for (let box = code; box !== document.body; box = box.parentElement) if (scrolls(box)) return false;
    return true;
}).map(code => code.textContent.slice(0, 60))"""
"""Blocks of code that are wider than they are shown and do not scroll."""


@pytest.fixture(scope="module")
def browser():
    with launched() as started:
        yield started


@pytest.fixture(scope="module")
def site(browser, tmp_path_factory):
    """Build the site without the figures of its examples."""
    if not DOCS.is_dir():
        pytest.skip("the docs stand in a checkout only")
    if find_spec("sphinx_gallery") is None:
        no_browser("Sphinx, which builds the site, is not installed: pip install -e '.[docs]'")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-b", "html", "-D", "plot_gallery=0", "-d", str(folder / "trees")]
    subprocess.run([*command, str(DOCS), str(folder / "html")], check=True, capture_output=True, text=True)
    return folder / "html"


@pytest.fixture(scope="module")
def results(browser, tmp_path_factory):
    """Write a run, a job, a study, a comparison and an isolator with their pages."""
    folder = tmp_path_factory.mktemp("results")
    with chdir(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        prepare(folder)
        for name in NEEDED:
            assert main(WRITING[name]) in (0, 1), name
    return folder


@pytest.fixture(params=[*SITE, *RESULTS])
def address(request):
    name = request.param
    if name in SITE:
        return (request.getfixturevalue("site") / f"{name}.html").as_uri()
    return (request.getfixturevalue("results") / RESULTS[name]).as_uri()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_page_has_no_critical_or_serious_finding(browser, address, scheme):
    try:
        from axe_playwright_python.sync_playwright import Axe
    except ImportError:
        no_browser("axe-playwright-python, which looks at the pages, is not installed: pip install -e '.[test]'")
    with opened(browser, address, color_scheme=scheme) as page:
        found = Axe().run(page).response["violations"]
    heavy = {
        finding["id"]: [node["html"][:120] for node in finding["nodes"]]
        for finding in found if finding["impact"] in ("critical", "serious")
    }  # fmt: skip
    assert not heavy


@pytest.mark.parametrize("width", [390, 1440])
def test_no_code_is_cut_and_the_page_fits_the_screen(browser, address, width):
    with opened(browser, address, viewport={"width": width, "height": 900}) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(CUT) == []
