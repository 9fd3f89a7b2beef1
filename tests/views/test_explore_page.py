"""The page of a what-if in a real browser: what moves when a slider does, and that nothing else is asked for anything."""

from contextlib import contextmanager
from threading import Thread

import pytest
from browsers import launched, opened

from wirerope_mj.runs.explore import Exploration
from wirerope_mj.runs.scenario import load_scenario
from wirerope_mj.views.explore.server import ExploreServer

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PATIENCE = 120_000
"""Time after which what is waited for is given up [ms]: no measure of speed, which depends on what else the machine does."""

LEVEL = "Base motion level"


def expect(locator):
    from playwright.sync_api import expect

    return expect(locator)


@pytest.fixture(scope="module")
def browser():
    with launched() as started:
        yield started


@contextmanager
def served(scenario, **values):
    """Yield a server of a shipped scenario; without values it has no viewer."""
    explored = Exploration(load_scenario(scenario).make(**values))
    with ExploreServer(explored, viewer=bool(values)) as server:
        thread = Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield server
        server.shutdown()
        thread.join()
    explored.close()


@pytest.fixture(scope="module")
def floor():
    with served("floating_floor_shock", level_g=15.0) as server:
        yield server


@contextmanager
def shown(browser, server, **options):
    """Yield the page once it shows a verdict."""
    with opened(browser, server.address, hosts=server.hosts, **options) as page:
        expect(page.locator("#headline")).to_contain_text("checks", timeout=PATIENCE)
        yield page


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


def rested(page):
    """Wait until the page shows the run of the last position."""
    expect(page.locator("#result")).to_have_attribute("aria-busy", "false", timeout=PATIENCE)


def reset(page):
    page.get_by_role("button", name="Reset all").click()
    rested(page)
    assert "17 of 132 checks exceeded" in headline(page)


def test_the_level_slider_changes_the_verdict(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        for position, words in (
            (200, "all 132 checks are within limits"),
            (400, "FAIL"),
            (200, "all 132 checks are within limits"),
        ):
            move(page, LEVEL, position)
            rested(page)
            assert words in headline(page)
        assert page.locator("#verdict").get_attribute("class") == "verdict unjudged"  # of the payload nothing is judged


def test_the_last_two_runs_lie_over_each_other(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        move(page, LEVEL, 200)
        rested(page)
        assert "PASS" in headline(page)
        assert page.locator("#curves svg").count() == 2
        for number in range(2):
            lines = page.locator("#curves svg").nth(number).locator("polyline")
            assert [lines.nth(n).get_attribute("class") for n in range(2)] == ["line before", "line now"]
        table = page.locator("#figures").inner_text()
        assert "17 of 132" in table
        assert "0 of 132" in table


def test_a_slider_that_is_dragged_asks_for_one_run_at_a_time_and_ends_where_it_rests(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        name = page.locator("#now-name").text_content().removeprefix("now: ")
        held, asked = [], []
        page.on("request", lambda request: asked.append(request.url) if request.url.endswith("/run") else None)
        page.route("**/run", lambda route: route.continue_() if held else held.append(route))  # the first is not answered yet
        box = page.get_by_label(LEVEL, exact=True).bounding_box()
        row = box["y"] + box["height"] / 2
        # From where the factor is 1, log(1 / 0.1) / log(2 / 0.1) of the way, the thumb being 16 px wide.
        page.mouse.move(box["x"] + 8 + 0.769 * (box["width"] - 16), row)
        page.mouse.down()
        for step in range(60):
            page.mouse.move(box["x"] + (0.769 - 0.01 * step) * box["width"], row)
        page.mouse.up()
        assert len(asked) == 1, "sixty movements would have been sixty runs"
        held[0].continue_()
        rested(page)
        assert len(asked) == 2
        assert "all 132 checks are within limits" in headline(page)
        value = page.get_by_label(f"{LEVEL}, as a number [times]").input_value()
        assert f"{LEVEL} ×\N{NO-BREAK SPACE}{float(value):.4g}" in page.locator("#state").text_content()
        assert page.locator("#before-name").text_content() == f"before: {name}"


def test_every_slider_can_be_moved_by_keys_and_says_its_value(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        for label in page.locator(".field label").all_text_contents():
            slider = page.get_by_label(label, exact=True)
            slider.focus()
            before = slider.get_attribute("aria-valuetext")
            page.keyboard.press("PageUp")
            assert slider.get_attribute("aria-valuetext") != before
            assert slider.get_attribute("aria-valuetext").endswith(("times the scenario's", "degrees"))
        rested(page)
        expect(page.locator("#state")).to_contain_text("Damping of all mounts")


def test_a_number_that_is_typed_is_brought_into_its_range(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        number = page.get_by_label(f"{LEVEL}, as a number [times]")
        for typed, kept in (("0.35", "0.35"), ("99", "2"), ("", "2")):
            number.fill(typed)
            number.press("Tab")
            assert number.input_value() == kept
        rested(page)
        expect(page.locator("#state")).to_contain_text("Base motion level ×\N{NO-BREAK SPACE}2")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1440])
def test_nothing_is_clipped(browser, floor, width, scheme):
    with shown(browser, floor, viewport={"width": width, "height": 900}, color_scheme=scheme) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        boxes = [page.locator(name).bounding_box() for name in ("#lines", "#figures", "#curves")]
        boxes += [table.bounding_box() for table in page.locator("#tables .wide").all()]  # wide tables scroll in theirs
        assert len(boxes) == 7
        for box in boxes:
            assert box["x"] >= 0.0
            assert box["x"] + box["width"] <= width


def test_without_its_server_the_page_says_so(browser):
    with served("shock_table") as server, shown(browser, server) as page:
        page.route("**/run", lambda route: route.abort())
        move(page, LEVEL, 300)
        expect(page.locator("#failure")).to_contain_text("wirerope explore does not answer")
        page.unroute("**/run")
        move(page, LEVEL, 400)
        rested(page)
        assert "FAIL" in headline(page)
        expect(page.locator("#failure")).to_be_hidden()


def test_the_viewer_shows_the_recording_and_the_verdict_does_not_wait_for_it(browser, floor):
    with shown(browser, floor) as page:
        reset(page)
        page.locator("#viewer-start").click()  # this browser has no graphics card
        expect(page.locator("#viewer-state")).to_contain_text("here after", timeout=2 * PATIENCE)
        held = []
        page.route("**/recording/*", lambda route: route.continue_() if held else held.append(route))
        with page.expect_request("**/recording/*", timeout=PATIENCE):
            move(page, LEVEL, 200)
        move(page, LEVEL, 400)  # while that recording is still on its way
        rested(page)
        assert "FAIL" in headline(page)
        held[0].continue_()
        name = page.locator("#now-name").text_content().removeprefix("now: ")
        expect(page.locator("#viewer-state")).to_contain_text(f"{name}, here after", timeout=2 * PATIENCE)
