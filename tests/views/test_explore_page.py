"""The page of a what-if in a real browser: what moves when a slider does, and that nothing else is asked for anything."""

import shutil
import time
from contextlib import contextmanager
from threading import Thread

import pytest

from wirerope_mj.runs.explore import Exploration
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.explore.server import ExploreServer

api = pytest.importorskip("playwright.sync_api", reason="the page is driven by playwright, which is not installed")

pytestmark = pytest.mark.slow

WITHIN = 2.0
"""Time in which the verdict follows a slider [s]: what a person takes for an answer to what the hand did."""

LEVEL = "Base motion level"


@pytest.fixture(scope="module")
def browser():
    """Return a browser without a window."""
    path = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    with api.sync_playwright() as playwright:
        try:
            started = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        except api.Error as error:
            pytest.skip(f"no chromium is installed: {error.message.splitlines()[0]}")
        yield started
        started.close()


@pytest.fixture(scope="module")
def floor():
    """Return a server of the shipped floor."""
    explored = Exploration(load_scenario("floating_floor_shock").make(level_g=15.0))
    with ExploreServer(explored, viewer=True) as server:
        thread = Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server
        server.shutdown()
        thread.join()
    explored.close()


@contextmanager
def opened(browser, server, **options):
    """Yield the page once it shows a verdict; errors in it, and requests that leave the machine, fail the test."""
    ours = tuple(f"http://{host}/" for host in server.hosts)
    errors, foreign = [], []
    page = browser.new_page(**{"viewport": {"width": 1440, "height": 900}, **options})
    page.on("pageerror", lambda error: errors.append(error))  # playwright marks what it is given
    page.on("request", lambda one: foreign.append(one.url) if not one.url.startswith((*ours, "data:", "blob:")) else None)
    page.goto(server.address)
    api.expect(page.locator("#headline")).to_contain_text("checks")
    yield page
    page.close()
    assert not errors
    assert not foreign


def move(page, label, value):
    """Move a slider as a hand does that lets go of it: `value` is typed into the field beside it, or is its position."""
    slider = page.get_by_label(label, exact=True)
    slider.evaluate(
        "(one, value) => { one.value = value; for (const kind of ['input', 'change'])"
        " one.dispatchEvent(new Event(kind, { bubbles: true })); }",
        value,
    )


def headline(page):
    return page.locator("#headline").text_content()


def seconds_until(page, changed):
    began = time.perf_counter()
    while not changed():
        assert time.perf_counter() - began < 30.0
        time.sleep(5e-3)
    return time.perf_counter() - began


def reset(page):
    page.get_by_role("button", name="Reset all").click()
    api.expect(page.locator("#headline")).to_contain_text("FAIL: 17 of 132 checks exceeded")


def test_the_level_slider_changes_the_verdict_within_two_seconds(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        for position, words in ((200, "PASS: all 132 checks"), (400, "FAIL"), (200, "PASS: all 132 checks")):
            before = headline(page)
            move(page, LEVEL, position)
            took = seconds_until(page, lambda before=before: headline(page) != before)
            assert words in headline(page)
            assert took < WITHIN, f"the verdict came after {took:.2f} s"
            api.expect(page.locator("#result")).to_have_attribute("aria-busy", "false")
        assert page.locator("#verdict").get_attribute("class") == "verdict within"


def test_the_last_two_runs_lie_over_each_other(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        move(page, LEVEL, 200)
        api.expect(page.locator("#headline")).to_contain_text("PASS")
        assert page.locator("#curves svg").count() == 2
        for number in range(2):
            lines = page.locator("#curves svg").nth(number).locator("polyline")
            assert [lines.nth(n).get_attribute("class") for n in range(2)] == ["line before", "line now"]
        table = page.locator("#figures").inner_text()
        assert "17 of 132" in table
        assert "0 of 132" in table


def test_a_slider_that_is_dragged_simulates_what_it_can_and_ends_where_it_rests(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        rested = page.locator("#now-name").text_content().removeprefix("now: ")
        asked = []
        page.on("request", lambda one: asked.append(one.url) if one.url.endswith("/run") else None)
        box = page.get_by_label(LEVEL, exact=True).bounding_box()
        row = box["y"] + box["height"] / 2
        # From where the factor is 1, log(1 / 0.1) / log(2 / 0.1) of the way, the thumb being 16 px wide.
        page.mouse.move(box["x"] + 8 + 0.769 * (box["width"] - 16), row)
        page.mouse.down()
        for step in range(60):
            page.mouse.move(box["x"] + (0.769 - 0.01 * step) * box["width"], row)
            time.sleep(0.02)
        page.mouse.up()
        took = seconds_until(page, lambda: page.locator("#result").get_attribute("aria-busy") == "false")
        assert took < WITHIN
        assert len(asked) <= 15, "sixty movements in 1.5 s would have been sixty runs"
        assert "PASS: all 132 checks" in headline(page)
        value = page.get_by_label(f"{LEVEL}, as a number [times]").input_value()
        assert f"{LEVEL} ×\N{NO-BREAK SPACE}{float(value):.4g}" in page.locator("#state").text_content()
        assert page.locator("#before-name").text_content() == f"before: {rested}"


def test_every_slider_can_be_moved_by_keys_and_says_its_value(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        for label in page.locator(".field label").all_text_contents():
            slider = page.get_by_label(label, exact=True)
            slider.focus()
            before = slider.get_attribute("aria-valuetext")
            page.keyboard.press("PageUp")
            assert slider.get_attribute("aria-valuetext") != before
            assert slider.get_attribute("aria-valuetext").endswith(("times the scenario's", "degrees"))
        api.expect(page.locator("#result")).to_have_attribute("aria-busy", "false", timeout=30_000)
        api.expect(page.locator("#state")).to_contain_text("Damping of all mounts")


def test_a_number_that_is_typed_is_brought_into_its_range(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        number = page.get_by_label(f"{LEVEL}, as a number [times]")
        for typed, kept in (("0.35", "0.35"), ("99", "2"), ("", "2")):
            number.fill(typed)
            number.press("Tab")
            assert number.input_value() == kept
        api.expect(page.locator("#state")).to_contain_text("Base motion level ×\N{NO-BREAK SPACE}2", timeout=30_000)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1440])
def test_nothing_is_clipped(browser, floor, width, scheme):
    with opened(browser, floor, viewport={"width": width, "height": 900}, color_scheme=scheme) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        boxes = [page.locator(name).bounding_box() for name in ("#lines", "#figures", "#curves")]
        boxes += [table.bounding_box() for table in page.locator("#tables .wide").all()]  # wide tables scroll in theirs
        assert len(boxes) == 7
        for box in boxes:
            assert box["x"] >= 0.0
            assert box["x"] + box["width"] <= width


def test_without_its_server_the_page_says_so(browser):
    explored = Exploration(load_scenario("shock_table").make())
    with ExploreServer(explored, viewer=False) as server:
        thread = Thread(target=server.serve_forever, daemon=True)
        thread.start()
        with opened(browser, server) as page:
            page.route("**/run", lambda route: route.abort())
            move(page, LEVEL, 300)
            api.expect(page.locator("#failure")).to_contain_text("wirerope explore does not answer")
            page.unroute("**/run")
            move(page, LEVEL, 400)
            api.expect(page.locator("#headline")).to_contain_text("FAIL")
            api.expect(page.locator("#failure")).to_be_hidden()
        server.shutdown()
        thread.join()


def test_the_viewer_shows_the_recording_and_the_verdict_does_not_wait_for_it(browser, floor):
    with opened(browser, floor) as page:
        reset(page)
        page.locator("#viewer-start").click()  # this browser has no graphics card
        api.expect(page.locator("#viewer-state")).to_contain_text("here after", timeout=120_000)
        move(page, LEVEL, 200)
        took = seconds_until(page, lambda: "PASS" in headline(page))
        assert took < WITHIN, f"the verdict came after {took:.2f} s"
        name = page.locator("#now-name").text_content().removeprefix("now: ")
        api.expect(page.locator("#viewer-state")).to_contain_text(f"{name}, here after", timeout=120_000)
