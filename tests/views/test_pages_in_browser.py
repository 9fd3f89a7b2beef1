"""A run's page and its shared folder in a real browser: their scripts run, and nothing is asked of other servers."""

from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import pytest
from browsers import launched, opened

import wirerope_mj as wr
from wirerope_mj.runs.report import share_run
from wirerope_mj.runs.scenario import load_scenario

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "table"
    wr.run_scenario(load_scenario("shock_table").make(duration=0.12, level_g=60.0), folder)
    return folder


@pytest.fixture(scope="module")
def browser():
    with launched() as started:
        yield started


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@contextmanager
def served(folder):
    """Yield the host at which a folder is served."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=folder)) as server:
        thread = Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield f"127.0.0.1:{server.server_port}"
        server.shutdown()
        thread.join()


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (1440, "light")])
def test_the_report_reads_its_curves_at_the_pointer_and_fits_the_screen(browser, run, width, scheme):
    size = {"width": width, "height": 900}
    with opened(browser, (run / "report.html").as_uri(), viewport=size, color_scheme=scheme) as page:
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        reading = page.locator(".read")
        assert reading.is_hidden()
        chart = page.locator("svg.chart").first
        chart.scroll_into_view_if_needed()
        box = chart.bounding_box()
        page.mouse.move(box["x"] + 0.2 * min(box["width"], width), box["y"] + 0.4 * box["height"])
        assert reading.is_visible()
        assert len(reading.inner_text().splitlines()) >= 2


@pytest.mark.slow
def test_the_shared_folder_opens_its_timeline_at_the_instant_of_the_address(browser, run, tmp_path):
    from playwright.sync_api import expect

    share_run(run, tmp_path / "out")
    with served(tmp_path / "out") as host, opened(browser, f"http://{host}/viewer/index.html#0.05", hosts=[host]) as page:
        expect(page).to_have_title("Timeline at 0.0500 s", timeout=120_000)  # software draws: it takes half a minute
        expect(page.locator("#state")).to_be_empty()
