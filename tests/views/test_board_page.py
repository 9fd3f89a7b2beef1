"""The page of the drawing board in a browser: what is drawn, dragged, typed and sent."""

import copy
import json
from threading import Event, Thread

import pytest
from browsers import launched, no_browser, opened

from wirerope_mj.views.board.server import BoardServer
from wirerope_mj.views.board.shapes import drawn

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PATIENCE = 30.0
SCRIPT = "<img src=x onerror=alert(1)>"
TEXTS = """name => [...document.querySelectorAll(`#${name} .label`)].map(text => {
    const { left, top, right, bottom } = text.getBoundingClientRect(), view = text.ownerSVGElement.getBoundingClientRect();
    return { words: text.textContent, box: [left - view.left, top - view.top, right - view.left, bottom - view.top],
             room: [view.width, view.height] };
})"""
"""Labels of a view with their rectangles."""
MIDDLE = """selector => {
    const { left, right, top, bottom } = document.querySelector(selector).getBoundingClientRect();
    return [left + right, top + bottom].map(sum => Number((sum / 2).toFixed(2)));
}"""


def mount(name, position, used, axial=(0, 0, 1)):
    tone = "quiet" if used is None else "exceeded" if used > 1 else "within"
    return {
        "kind": "mount", "name": f"mount/{name}", "label": name, "part": "WR16-400", "movable": True,
        "position": list(position), "axial": list(axial),
        "bars": [1, 0, 0], "height": 89, "width": 105, "used": used, "tone": tone,
    }  # fmt: skip


def machine():
    """Compose a machine on four inclined mounts, one of them off the grid, on a deck."""
    mounts = [
        mount(f"m{k + 1}", (x, y, 100), used, (0, -0.5 if y > 0 else 0.5, 0.866))
        for k, (x, y, used) in enumerate([(-403, -300, 0.83), (400, -300, 1.24), (-400, 300, 0.5), (400, 300, None)])
    ]
    still = {"movable": False}
    return [
        *mounts,
        {"kind": "mass", "name": "mass/m", "label": SCRIPT, "position": [0, 0, 500], "size": [600, 300, 400], "movable": True},
        {"kind": "deck", "name": "deck/d", "label": "deck", "position": [0, 0, 40], "size": [2000, 900, 20], **still},
        {"kind": "stop", "name": "stop/s1", "label": "s1", "position": [0, -300, 100], "movable": True},
        {"kind": "point", "name": "point/top", "label": "top", "position": [0, 0, 800], "movable": True},
        {"kind": "centre", "mark": "stiffness", "label": "of stiffness", "position": [30, 40, 100], **still},
        {"kind": "centre", "mark": "mass", "label": "of mass", "position": [0, 0, 500], **still},
    ]


def floor():
    """Compose a floor on forty mounts."""
    places = [(900 * k, 1500 * row, 44) for row in range(4) for k in range(10)]
    return [mount(f"f{n + 1}", place, 0.3 + 0.02 * n) for n, place in enumerate(places)]


class Board:
    """A board that keeps what it is asked for and moves what it has drawn."""

    title = "genset"

    def __init__(self, items):
        self.items, self.taken, self.answers, self.closed, self.go = items, [], 0, Event(), Event()
        self.go.set()

    def open(self):
        return {"scene": drawn(self.items), "html": self.form()}

    def form(self):
        self.answers += 1
        return {
            "left": f'<p>answer {self.answers}</p><details id="more"><summary>more</summary>more</details>'
            '<input id="mass" data-do="cell" data-row="engine" aria-label="mass" value="600">'
            '<input id="height" type="range" data-do="slide" data-live aria-label="height">'
        }

    def act(self, action):
        self.taken.append(action)
        yield True, getattr(self, action["do"], lambda _: {})(action)

    def moved(self, action):
        items = copy.deepcopy(self.items)
        for item in items:
            if item.get("name") in action["names"]:
                item["position"] = [value + by for value, by in zip(item["position"], action["by"], strict=True)]
        return items

    def drag(self, action):
        self.go.wait(PATIENCE)
        items = self.moved(action)
        for item in items:
            item |= {"used": 0.77, "tone": "within"} if item["kind"] == "mount" else {}
            item["collides"] = item.get("name") in action["names"]
        return {"scene": drawn(items, names=action["names"], by=action["by"])}

    def move(self, action):
        if "mount/m4" in action["names"]:
            raise ValueError("m4 stays")
        self.items = self.moved(action)
        return {"scene": drawn(self.items), "dirty": True}

    def slide(self, action):
        return {"html": self.form()}

    def report(self, action):
        return {"open": "/viewer?recording=a%20b.rrd#0.05"}

    def cell(self, action):
        return {"html": self.form()}

    def changed_outside(self):
        return None

    def file(self, name):
        return None

    def close(self):
        self.closed.set()

    def of(self, *kinds):
        """List what was asked for of some kinds, without its number."""
        return [{key: value for key, value in action.items() if key != "id"} for action in self.taken if action["do"] in kinds]


@pytest.fixture(scope="module")
def browser():
    with launched() as started:
        yield started


@pytest.fixture
def served(request):
    board = Board(getattr(request, "param", machine)())
    server = BoardServer(board)
    thread = Thread(target=server.run)
    thread.start()
    try:
        yield board, server
    finally:
        server.should_exit = True
        thread.join(PATIENCE)
        assert not thread.is_alive()


@pytest.fixture
def page(browser, served):
    with opened(browser, served[1].address, hosts=served[1].hosts, viewport={"width": 1280, "height": 720}) as shown:
        shown.wait_for_selector("#plan .mount")
        yield shown


def middle(page, view, name):
    """Measure where an item stands, in one step: a view is drawn anew at any time."""
    return page.evaluate(MIDDLE, f'#{view} [data-name="{name}"] .shape')


def scale_of(page):
    """Measure the pixels of a millimetre between two mounts."""
    return (middle(page, "plan", "mount/m2")[0] - middle(page, "plan", "mount/m1")[0]) / 803


def drag(page, view, name, x, y):
    """Press on an item and move the pointer by lengths [mm] to the right and up."""
    left, top = middle(page, view, name)
    scale = scale_of(page)
    page.mouse.move(left, top)
    page.mouse.down()
    page.mouse.move(left + x * scale, top - y * scale, steps=5)


def until(page, holds):
    """Wait until something holds, and fail if it never does."""
    for _ in range(round(PATIENCE / 0.02)):
        if holds():
            return
        page.wait_for_timeout(20)
    raise AssertionError("this never came about")


def wait_for(page, words):
    page.wait_for_function("words => document.querySelector('#here').textContent.includes(words)", arg=words)


def test_a_drag_snaps_to_the_grid_along_the_axes_that_it_travels(page, served):
    board, _ = served
    drag(page, "plan", "mount/m1", 100, 0)
    page.wait_for_selector('#plan .collides[data-name="mount/m1"]')
    page.wait_for_function("() => document.querySelector('#plan').textContent.includes('m2 77 %')")
    assert "by x 103 y 0 to x −300 y −300" in page.text_content("#plan .travel")
    page.mouse.up()
    wait_for(page, "x −300 y −300 z 100 mm, 83 % used")
    assert board.of("move") == [{"do": "move", "names": ["mount/m1"], "by": [103, 0, 0]}]
    assert page.title() == "• genset"


def test_all_that_is_selected_moves_in_steps_of_a_millimetre_with_shift(page, served):
    board, _ = served
    page.mouse.click(*middle(page, "plan", "mount/m1"))
    page.keyboard.down("Shift")
    page.mouse.click(*middle(page, "plan", "stop/s1"))
    drag(page, "elevation", "stop/s1", 0, 33)
    page.mouse.up()
    page.keyboard.up("Shift")
    page.wait_for_function("() => document.title.startsWith('•')")
    (move,) = board.of("move")
    assert set(move["names"]) == {"mount/m1", "stop/s1"}
    assert move["by"][:2] == [0, 0]
    assert move["by"][2] == pytest.approx(33, abs=2)  # of a pixel's length
    assert move["by"][2] % 10


def test_escape_takes_a_drag_back_and_a_move_that_fails_is_not_drawn(page, served):
    board, _ = served
    before = middle(page, "plan", "mount/m4")
    drag(page, "plan", "mount/m4", 100, 100)
    page.keyboard.press("Escape")
    page.mouse.up()
    until(page, lambda: [action["by"] for action in board.of("drag")][-1:] == [[0, 0, 0]])
    until(page, lambda: middle(page, "plan", "mount/m4") == before)
    assert not board.of("move")
    drag(page, "plan", "mount/m4", 100, 100)
    page.mouse.up()
    page.wait_for_function("() => document.querySelector('#said').textContent === 'm4 stays'")
    until(page, lambda: middle(page, "plan", "mount/m4") == before)
    assert len(board.of("move")) == 1


def test_one_drag_at_a_time_is_asked_for_and_then_the_newest(page, served):
    board, _ = served
    board.go.clear()
    drag(page, "plan", "mount/m1", 100, 0)
    until(page, lambda: board.of("drag"))
    page.mouse.move(*middle(page, "plan", "mount/m2"))
    board.go.set()
    until(page, lambda: len(board.of("drag")) == 2)
    page.mouse.up()
    until(page, lambda: board.of("move"))
    assert board.of("drag")[1]["by"] == board.of("move")[0]["by"] != board.of("drag")[0]["by"]


def test_an_address_of_the_server_is_opened_beside_with_the_token(page, served):
    with page.context.expect_page() as opening:
        page.click("[data-do=report]")
    token = served[1].token
    assert opening.value.url.endswith(f"/viewer?recording=a+b.rrd&token={token}#0.05")


def test_keys_step_through_the_items_move_and_edit_them(page, served):
    board, _ = served
    page.focus("#plan")
    for key in ("PageDown", "PageDown", "PageUp"):
        page.keyboard.press(key)
    wait_for(page, "mount m1, WR16-400")
    page.keyboard.down("ArrowRight")
    page.keyboard.down("ArrowRight")
    page.keyboard.up("ArrowRight")  # a key that is held is one move
    wait_for(page, "x −383")
    page.keyboard.press("Alt+Shift+ArrowUp")
    wait_for(page, "z 101")
    assert [action["by"] for action in board.of("move")] == [[20, 0, 0], [0, 0, 1]]
    for key in ("r", "Shift+R", "Shift+M", "Control+d", "Control+z", "Control+y", "Control+s", "Control+a", "Delete"):
        page.keyboard.press(key)
    until(page, lambda: board.of("remove"))
    edits = board.of("turn", "mirror", "duplicate", "undo", "redo", "save", "remove")
    one, all_four = ["mount/m1"], [f"mount/m{k}" for k in (1, 2, 3, 4)]
    assert edits == [
        {"do": "turn", "names": one, "degrees": "90"}, {"do": "turn", "names": one, "degrees": "45"},
        {"do": "mirror", "names": one, "axis": "y"}, {"do": "duplicate", "names": one}, {"do": "undo"}, {"do": "redo"},
        {"do": "save"}, {"do": "remove", "names": all_four},
    ]  # fmt: skip


def test_a_rectangle_selects_what_lies_in_it(page, served):
    view, mount_1 = page.locator("#plan").bounding_box(), middle(page, "plan", "mount/m1")
    page.mouse.move(mount_1[0] - 40, mount_1[1] + 20)
    page.mouse.down()
    page.mouse.move(mount_1[0] + 40, view["y"] + 30, steps=3)
    page.mouse.up()
    wait_for(page, "2 selected: m1, m3")


def test_a_fragment_leaves_what_is_typed_and_unfolded(page, served):
    board, _ = served
    page.click("summary:has-text('more')")
    page.click("#mass")
    page.keyboard.press("End")
    page.keyboard.type("5")
    page.evaluate("document.querySelector('#height').dispatchEvent(new Event('input', { bubbles: true }))")
    page.wait_for_function("() => document.querySelector('#left').textContent.includes('answer 2')")
    assert page.input_value("#mass") == "6005"
    assert page.evaluate("[document.activeElement.id, document.activeElement.selectionStart]") == ["mass", 4]
    assert page.evaluate("document.querySelector('#more').open")
    page.keyboard.press("Enter")
    page.wait_for_function("() => document.querySelector('#mass').value === '600'")  # as the board has it
    assert board.of("cell") == [{"do": "cell", "row": "engine", "value": "6005"}]
    assert board.of("slide")[0]["passing"] is True


def test_a_row_that_is_renamed_keeps_what_is_typed_into_it(page, served):
    board, _ = served
    row = '<table><tbody><tr data-name="mass/{0}">' + "".join(
        f'<td><input id="{{0}}-{column}" data-do="cell" data-column="{column}" data-row="{{0}}" value="{value}"></td>'
        for column, value in (("name", "{0}"), ("mass", "60"))
    ) + '</tr><tr data-name="mass/lid"><td><input data-column="mass" value="2"></td></tr></tbody></table>'  # fmt: skip
    board.slide = lambda _: {"html": {"left": row.format("camera")}}
    list_of = "() => [...document.querySelectorAll('#left input')].map(field => field.value).join()"
    page.evaluate("document.querySelector('#height').dispatchEvent(new Event('input', { bubbles: true }))")
    page.wait_for_function(f"() => ({list_of})() === 'camera,60,2'")
    board.cell = lambda action: {"html": {"left": row.format(action["value"])}} if action["row"] == "camera" else {}
    page.fill("#camera-name", "lens")
    page.keyboard.press("Tab")
    page.keyboard.type("61")
    page.wait_for_selector("#lens-mass")
    assert page.evaluate("document.activeElement.id") == "lens-mass"
    page.keyboard.press("Enter")
    page.wait_for_function(f"() => ({list_of})().startsWith('lens,')")
    assert board.of("cell")[-1] == {"do": "cell", "column": "mass", "row": "lens", "value": "61"}


def test_a_field_that_adds_is_empty_for_the_next_and_has_back_what_is_refused(page, served):
    board, _ = served
    fields = '<div class="limit" id="limit-of"><input id="new" data-do="add" data-adds value=""></div>'
    board.slide = lambda _: {"html": {"left": fields}}
    page.evaluate("document.querySelector('#height').dispatchEvent(new Event('input', { bubbles: true }))")
    page.wait_for_selector("#new")

    def add(action):
        board.go.wait(PATIENCE)
        if action["value"] == "wrong":
            return {"refused": action["id"], "said": "no limit"}
        return {"html": {"left": f'<div class="limit" id="limit-of-a"><input id="a" value="{action["value"]}"></div>{fields}'}}

    board.add = add
    page.fill("#new", "wrong")
    page.keyboard.press("Enter")
    page.wait_for_selector(".refusal")
    assert page.input_value("#new") == "wrong"
    page.focus("#new")
    page.keyboard.press("Enter")  # as it stands, once more
    page.wait_for_function("() => document.body.dataset.waits === 'false'")
    assert len(board.of("add")) == 2
    board.go.clear()
    page.fill("#new", "10 g")
    page.keyboard.press("Enter")
    assert page.input_value("#new") == ""
    page.keyboard.type("20 g")
    board.go.set()
    page.wait_for_selector("#a")
    assert page.input_value("#a") == "10 g"
    assert page.input_value("#new") == "20 g"
    page.wait_for_selector(".refusal", state="detached")


def test_an_action_that_is_lost_with_its_connection_is_sent_again(browser, served):
    board, server = served
    lost, kept = [], []

    def route(window):
        there = window.connect_to_server()

        def hand_on(message):
            action = json.loads(message)
            if action["do"] == "undo" and not lost:
                lost.append(action["id"])
                there.close()
                window.close()
            else:
                kept.append(action["id"])
                there.send(message)

        window.on_message(hand_on)

    page = browser.new_page()
    page.route_web_socket("**/socket*", route)
    page.goto(server.address)
    page.wait_for_selector("#plan .mount")
    page.click("[data-do=undo]")
    page.wait_for_function("() => document.querySelector('#said').textContent.startsWith('Connection lost')")
    page.wait_for_function("() => document.querySelector('#said').textContent === ''")
    page.click("[data-do=redo]")
    until(page, lambda: board.of("redo"))
    page.close()
    assert [action["do"] for action in board.of("undo", "redo")] == ["undo", "redo"]
    assert kept.count(lost[0]) == 1


@pytest.mark.parametrize("served", [machine, floor], indirect=True)
@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080)])
def test_labels_are_whole_and_apart(browser, served, size):
    board, server = served
    with opened(
        browser, server.address, hosts=server.hosts, viewport=dict(zip(("width", "height"), size, strict=True))
    ) as page:
        page.wait_for_selector("#plan .mount")
        for view in ("plan", "elevation"):
            labels = page.evaluate(TEXTS, view)
            for n, label in enumerate(labels):
                left, top, right, bottom = label["box"]
                assert min(left, top) >= 0, label
                assert right <= label["room"][0], label
                assert bottom <= label["room"][1], label
                for other in labels[:n]:
                    a, b, c, d = other["box"]
                    over = min(right, c) - max(left, a), min(bottom, d) - max(top, b)
                    assert min(over) < 2, (label["words"], other["words"])
        words = [label["words"] for label in page.evaluate(TEXTS, "plan")]
        for entry in board.items:
            if entry["kind"] != "mount":
                continue
            assert any(word.split(" ")[0] == entry["label"] for word in words), entry["label"]
        assert not page.locator("img").count()  # names are texts


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [1280, 390])
def test_the_board_has_no_critical_or_serious_finding(browser, served, scheme, width):
    try:
        from axe_playwright_python.sync_playwright import Axe
    except ImportError:
        no_browser("axe-playwright-python, which looks at the pages, is not installed: pip install -e '.[test]'")
    how = {"color_scheme": scheme, "viewport": {"width": width, "height": 800}, "bypass_csp": True}
    with opened(browser, served[1].address, hosts=served[1].hosts, **how) as page:
        page.wait_for_selector("#plan .mount")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.focus("#plan")
        page.keyboard.press("PageDown")
        for shown in ("page", "keys"):
            if shown == "keys":
                page.click("[data-canvas=keys]")
            found = Axe().run(page).response["violations"]
            assert not [entry["id"] for entry in found if entry["impact"] in ("critical", "serious")], shown
