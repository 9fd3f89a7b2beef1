"""A drawing board in a real browser: served, shown under guard, and edited with the mouse or with keys alone."""

import os
import subprocess
from contextlib import contextmanager
from threading import Thread

from commands import WIREROPE

from wirerope_mj.runs.board.board import Board
from wirerope_mj.runs.board.opened import from_template, opened
from wirerope_mj.views.board.server import BoardServer

JOB = """# a short case
model = "."

[limits]
"acceleration/equipment" = "2 g"

[[case]]
name = "shock"
half-sine = "10 g 11 ms z"

[simulate]
duration = 0.3
"""
STOPS = """selector => {
    const stops = [...document.querySelectorAll("button:enabled, input, summary, [tabindex='0'], a")]
        .filter(each => each.checkVisibility());
    return [document.querySelector(selector), document.activeElement].map(each => stops.indexOf(each));
}"""
"""Number of an element, and of the one that has the focus, among those that Tab leads through."""
MIDDLE = """name => {
    const item = document.querySelector(`#plan [data-name="${name}"]`);
    const { left, right, top, bottom } = item.getBoundingClientRect();
    return [(left + right) / 2, (top + bottom) / 2];
}"""
LONG = 120.0
"""Time after which what is waited for is given up [s]: no measure of speed."""


def genset(folder):
    """Write the genset with a job of one short case that exceeds its limit."""
    from_template("genset", folder)
    (folder / "job.toml").write_text(JOB, encoding="utf-8")
    return folder


@contextmanager
def command(folder, *more):
    """Run `wirerope board` and yield the process and its address; it is killed at the end."""
    words = [*WIREROPE, "board", str(folder), "--no-browser", *more]
    with subprocess.Popen(words, cwd=folder.parent, text=True, stdout=subprocess.PIPE, env=os.environ) as process:
        try:
            yield process, process.stdout.readline().removeprefix("Open ").strip()
        finally:
            process.kill()


@contextmanager
def served(folder):
    """Serve a board in a thread, and yield its address."""
    server = BoardServer(Board(opened(folder)))
    thread = Thread(target=server.run)
    thread.start()
    try:
        yield server.address
    finally:
        server.should_exit = True
        thread.join(LONG)
        assert not thread.is_alive()


@contextmanager
def window(browser, address, *, parted=False, route=None, **options):
    """Yield a window of a board with its first verdict.

    Errors, dialogs, what the policy of a page forbids, and requests to other servers fail the test; `parted` says that its
    connection will be cut, which a browser reports as an error. `route` gets the socket, as playwright hands it over.
    """
    from playwright.sync_api import expect

    expect.set_options(timeout=1e3 * LONG)
    context = browser.new_context(**{"viewport": {"width": 1280, "height": 720}, **options})
    context.set_default_timeout(1e3 * LONG)
    origin = address.partition("/?")[0]
    ours = tuple(origin.replace("127.0.0.1", host) + "/" for host in ("127.0.0.1", "localhost"))
    errors, asked = [], []
    where = "{0.text} {0.location[url]}".format
    context.on("console", lambda message: errors.append(where(message)) if message.type == "error" else None)
    context.on("weberror", lambda error: errors.append(str(error.error)))
    context.on("request", lambda request: asked.append(request.url))
    page = context.new_page()
    page.on("dialog", lambda dialog: (errors.append(f"dialog: {dialog.message}"), dialog.dismiss()))
    page.on("websocket", lambda socket: asked.append(socket.url.replace("ws:", "http:")))
    if route:
        page.route_web_socket("**/socket*", route)
    page.goto(address)
    expect(page.locator("#headline")).to_be_visible()
    yield page
    context.close()
    errors = [error for error in errors if not (parted and ("WebSocket" in error or "Failed to load resource" in error))]
    ours += ("data:", "blob:", "about:", "chrome:", "chrome-extension:")  # the last two are of the browser's viewer of PDF
    foreign = [url for url in asked if not url.startswith(ours)]
    assert not errors, errors
    assert not foreign, foreign


def middle(page, name):
    """Measure where an item stands, in one step: the plan is drawn anew at any time."""
    return page.evaluate(MIDDLE, name)


def position(page, name):
    """Read where the plan says that an item stands."""
    return page.locator(f'#plan [data-name="{name}"]').get_attribute("aria-label")


class Mouse:
    """A hand that edits with the mouse, and types into the fields that it has clicked."""

    def __init__(self, page):
        self.page = page

    def move(self, name, steps):
        """Drag an item to the right by steps of 10 mm."""
        page, (x, y) = self.page, middle(self.page, name)
        scale = (middle(page, "stop/s2")[0] - middle(page, "stop/s1")[0]) / 1600
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 10 * steps * scale, y, steps=4)
        page.mouse.up()

    def press(self, selector):
        self.page.locator(selector).click()

    def select(self, name):
        self.page.mouse.click(*middle(self.page, name))

    def type(self, field, text):
        self.page.locator(field).click(click_count=3)
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    def save(self):
        self.press("[data-do=save]")


class Keys(Mouse):
    """A hand that has no mouse."""

    def focus(self, selector, key="Tab"):
        """Press a key until an element has the focus, as often as there seem to be others before it, and then one by one."""
        there, here = self.page.evaluate(STOPS, selector)
        for _ in range(max(here - there if key == "Shift+Tab" else there - here, 0)):
            self.page.keyboard.press(key)
        for _ in range(400):
            if self.page.evaluate("selector => document.activeElement?.matches(selector)", selector):
                return
            self.page.keyboard.press(key)
        raise AssertionError(f"{key} does not come to {selector}")

    def move(self, name, steps):
        self.select(name)
        for _ in range(steps):
            self.page.keyboard.down("ArrowRight")
        self.page.keyboard.up("ArrowRight")

    def press(self, selector):
        self.focus(selector, "Shift+Tab")  # on from the drawing come the fields, which select what they are about
        self.page.keyboard.press("Enter")

    def select(self, name):
        self.focus("#plan")
        for _ in range(60):
            before = self.page.locator("#here").inner_text()
            if before.startswith(name.replace("/", " ") + ","):
                return
            self.page.keyboard.press("PageDown")
            self.page.wait_for_function("before => document.querySelector('#here').innerText !== before", arg=before)
        raise AssertionError(f"Page Down does not come to {name}")

    def type(self, field, text):
        self.focus(field)
        self.page.keyboard.press("Control+a")
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    def save(self):
        self.page.keyboard.press("Control+s")
