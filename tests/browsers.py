"""A real browser without a window, for tests of pages: the one that is installed here, driven by playwright."""

import os
import shutil
from contextlib import contextmanager

import pytest

PROGRAMS = (
    "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge", "msedge",
)  # fmt: skip
CHANNELS = ("chrome", "msedge")  # what playwright finds where macOS and Windows install it, which is not on the path
DEMANDED = "BROWSER_TESTS"  # in the environment "required": a machine that must run these tests, where a skip is a failure


def browser_program():
    """Return the program of the browser that is installed: that of CHROME in the environment, Chromium, Chrome or Edge."""
    return os.environ.get("CHROME") or next(filter(None, map(shutil.which, PROGRAMS)), None)


def no_browser(reason):
    """Skip the test that needs a browser, or fail it where the environment says that there must be one."""
    if os.environ.get(DEMANDED) == "required":
        pytest.fail(f"{DEMANDED} is 'required' and {reason}", pytrace=False)
    pytest.skip(reason)


@contextmanager
def launched():
    """Yield the browser of this machine; the test is skipped where there is none."""
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        no_browser("playwright, which drives the browser, is not installed: pip install -e '.[test]'")
    program = browser_program()
    choices = [{"executable_path": program}] if program else [{"channel": channel} for channel in CHANNELS]
    with sync_playwright() as playwright:
        failures = []
        for choice in choices:
            try:
                browser = playwright.chromium.launch(**choice, args=["--no-sandbox"])
                break
            except Error as error:
                failures.append(error.message.splitlines()[0])
        else:
            no_browser(
                f"no browser starts here: {'; '.join(failures)}. Install Chromium, Chrome or Edge, or name one as CHROME."
            )
        yield browser
        browser.close()


@contextmanager
def opened(browser, address, *, hosts=(), **options):
    """Yield a page at an address; errors in it, and requests that go elsewhere than to it and `hosts`, fail the test."""
    ours = (*(f"http://{host}/" for host in hosts), "file:", "data:", "blob:")
    errors, foreign = [], []
    page = browser.new_page(**{"viewport": {"width": 1440, "height": 900}, **options})
    page.on("pageerror", lambda error: errors.append(error))  # playwright marks what it is given
    page.on("request", lambda request: foreign.append(request.url) if not request.url.startswith(ours) else None)
    page.goto(address)
    yield page
    page.close()
    assert not errors
    assert not foreign
