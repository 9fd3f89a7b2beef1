"""The drawing board in a real browser: a genset from FAIL to PASS, other people's files, lost connections, hostile texts."""

import re
import signal
from contextlib import ExitStack
from itertools import product

import pytest
from boards import Keys, Mouse, command, genset, position, served, window
from browsers import launched, no_browser, opened
from commands import wirerope

pytestmark = pytest.mark.browser

SCRIPT = "<img/src=x/onerror=alert(1)><script>alert(2)</script>"
CRITERIA = """() => [...document.querySelectorAll('[data-id="criteria"] tbody tr')]
    .map(row => [...row.cells].map(cell => cell.textContent.replace(/\\s+/g, " ").trim()).join(" | "))"""
"""Rows of the table of criteria as they are read."""

MOUNTS = """
m1, -800, -300, 100, enidine_wr16_400, 30, 90
m2,    60, -300, 100, enidine_wr16_400, 30, 90
m3,  800, -300, 100, enidine_wr16_700, 30, 90
m4, -800,  300, 100, enidine_wr16_400, 30, -90
m5,    90,  300, 100, enidine_wr16_400, 30, -90
m6,  800,  469, 467, enidine_wr16_400, 90, -90
"""
"""The genset's table of mounts after `improve`."""


@pytest.fixture(scope="module")
def browser():
    with launched() as started:
        yield started


def expect(what):
    from playwright.sync_api import expect as expected

    return expected(what)


def texts(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix in (".csv", ".toml")}


def told(page, words):
    expect(page.locator("#said")).to_have_text(re.compile(words))


def improve(page, hand):
    """Edit the genset until it fails its limit and then holds it; 7 edits."""
    hand.type("#limit-new", "acceleration/equipment = 2 g")
    expect(page.locator("#headline")).to_have_text(re.compile("^FAIL: equipment"))
    hand.move("mount/m2", 6)
    told(page, "Moved m2")
    hand.move("mount/m5", 9)
    told(page, "Moved m5")
    hand.select("mount/m6")
    hand.press("[data-on=wall]")
    told(page, "Placed m6")
    hand.type("#mounts-m3-isolator", "enidine_wr16_700")
    told(page, "enidine_wr16_700")
    shock = page.locator("#case-0-motions")
    hand.type("#case-0-motions", "half-sine 3 gg 11 ms z")
    expect(shock).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#case-0-motions + .refusal")).to_contain_text('"gg" is no unit')
    assert shock.evaluate("field => field.value.slice(field.selectionStart, field.selectionEnd)") == "gg"
    page.keyboard.type("g")
    page.keyboard.press("Enter")
    told(page, "half-sine 3 g")
    expect(shock).not_to_have_attribute("aria-invalid", "true")
    expect(page.locator(".refusal")).to_have_count(0)
    hand.type("#limit-0", "2.5 g")
    expect(page.locator("#headline")).to_have_text(re.compile("^PASS"))


def test_a_genset_comes_from_fail_to_pass_and_the_command_says_the_same(browser, tmp_path):
    folder = tmp_path / "genset"
    with command(folder, "--template", "genset") as (_, address), window(browser, address) as page:
        hand = Mouse(page)
        hand.save()
        told(page, "^Saved")
        before = texts(folder)
        improve(page, hand)
        hand.save()
        told(page, "^Saved: job.toml, mounts.csv")
        expect(page).not_to_have_title(re.compile("\u2022"))
        assert texts(folder)["mounts.csv"].decode().endswith(MOUNTS)
        made = wirerope("cases", "job.toml", "--workers", "1", cwd=folder)
        assert made.returncode == 0, made.stderr
        (case,) = (folder / "runs" / "job" / "cases").iterdir()
        with opened(browser, (case / "report.html").as_uri()) as report:
            headline = report.locator("#headline").inner_text()
            rows = report.evaluate(CRITERIA)
        assert len(rows) > 4
        expect(page.locator("#headline")).to_have_text(headline)
        page.wait_for_function(f"rows => JSON.stringify(({CRITERIA})()) === JSON.stringify(rows)", arg=rows)
        for _ in range(7):
            page.keyboard.press("Control+z")
        hand.press("[data-do=undo]")
        told(page, "[Nn]othing to undo")
        hand.save()
        told(page, "^Saved")
        assert texts(folder) == before


def test_keys_alone_write_the_same_files(browser, tmp_path):
    folder = tmp_path / "genset"
    with command(folder, "--template", "genset") as (_, address), window(browser, address) as page:
        improve(page, Keys(page))
        Keys(page).save()
        told(page, "^Saved")
        assert texts(folder)["mounts.csv"].decode().endswith(MOUNTS)
        assert '"acceleration/equipment" = "2.5 g"' in texts(folder)["job.toml"].decode()


def test_what_others_write_is_shown_and_what_they_break_is_said(browser, tmp_path):
    folder = genset(tmp_path / "genset")
    mounts = folder / "mounts.csv"
    with served(folder) as address, window(browser, address) as page:
        sound = mounts.read_text(encoding="utf-8")
        mounts.write_text(sound.replace("m1, -800", "m1, -750"), encoding="utf-8")
        expect(page.locator('#plan [data-name="mount/m1"]')).to_have_attribute("aria-label", re.compile("x \u2212750 "))
        told(page, "changed outside")
        mounts.write_text(sound.replace("m1, -800", "m1, wide"), encoding="utf-8")
        told(page, "mounts.csv.*wide.*keeps what it had")
        assert "x \u2212750 " in position(page, "mount/m1")
        mounts.write_text(sound.replace("m1, -800", "m1, -700"), encoding="utf-8")
        expect(page.locator('#plan [data-name="mount/m1"]')).to_have_attribute("aria-label", re.compile("x \u2212700 "))


def test_of_edits_in_two_windows_none_is_lost(browser, tmp_path):
    folder = genset(tmp_path / "genset")
    with served(folder) as address, ExitStack() as stack:
        pages = [stack.enter_context(window(browser, address)) for _ in range(2)]
        for page, name in zip(pages, ("mount/m1", "mount/m6"), strict=True):
            Mouse(page).move(name, 5)
        for page in pages:
            expect(page.locator('#plan [data-name="mount/m1"]')).to_have_attribute("aria-label", re.compile("x \u2212750 "))
            expect(page.locator('#plan [data-name="mount/m6"]')).to_have_attribute("aria-label", re.compile("x 850 "))
            expect(page.locator("#mounts-m6-x")).to_have_value("850")
        Mouse(pages[1]).save()
        told(pages[0], "^Saved: mounts.csv")
        assert {"m1, -750", "m6,  850"} <= {line[:8] for line in (folder / "mounts.csv").read_text().splitlines()}


def test_what_is_done_while_the_connection_is_cut_is_applied_once(browser, tmp_path):
    folder, sockets, cut = genset(tmp_path / "genset"), [], []

    def route(socket):
        if cut:
            socket.close()
            return
        server = socket.connect_to_server()
        sockets.append((socket, server))
        # what the server answers is lost from the moment that the connection is cut, although it has taken the action
        server.on_message(lambda message: None if cut else socket.send(message))

    with served(folder) as address, window(browser, address, route=route) as page:
        hand = Mouse(page)
        cut.append(True)
        hand.move("mount/m1", 3)  # reaches the server, which is not heard
        sockets[-1][0].close()
        told(page, "^Connection lost")
        hand.move("mount/m3", 4)
        hand.type("#masses-engine-mass", "650")
        cut.clear()
        expect(page.locator('#plan [data-name="mount/m1"]')).to_have_attribute("aria-label", re.compile("x \u2212770 "))
        expect(page.locator('#plan [data-name="mount/m3"]')).to_have_attribute("aria-label", re.compile("x 840 "))
        expect(page.locator('#plan [data-name="mass/engine"]')).to_have_attribute("aria-label", re.compile("650 kg"))
        hand.save()
        told(page, "^Saved: masses.csv, mounts.csv|^Saved: mounts.csv, masses.csv")
        assert "\nm1, -770," in (folder / "mounts.csv").read_text()


def test_a_mount_that_is_let_go_in_another_goes_back(browser, tmp_path):
    with served(genset(tmp_path / "genset")) as address, window(browser, address) as page:
        Mouse(page).move("mount/m1", 75)
        told(page, "m1 and m2 would stand in each other")
        expect(page.locator("body")).to_have_attribute("data-stale", "false")
        expect(page.locator('#plan [data-name="mount/m1"]')).to_have_attribute("aria-label", re.compile("x \u2212800 "))
        expect(page.locator("#headline")).to_have_text(re.compile("^FAIL"))


def test_a_board_that_was_killed_has_what_was_not_saved(browser, tmp_path):
    folder = genset(tmp_path / "genset")
    before = texts(folder)
    with command(folder) as (process, address), window(browser, address, parted=True) as page:
        for name, steps in {"mount/m1": 3, "mount/m6": 4}.items():
            Mouse(page).move(name, steps)
            told(page, f"Moved {name[-2:]}")
        process.send_signal(signal.SIGKILL)
        process.wait()
        told(page, "^Connection lost")
        with command(folder, "--port", re.search(r":(\d+)/", address)[1]):
            told(page, "^This board was started anew")
    assert texts(folder) == before
    with command(folder) as (_, address), window(browser, address) as page:
        told(page, "not saved last time")
        assert "x \u2212770 " in position(page, "mount/m1")
        assert "x 840 " in position(page, "mount/m6")
        Mouse(page).press("[data-do=undo]")
        expect(page.locator('#plan [data-name="mount/m6"]')).to_have_attribute("aria-label", re.compile("x 800 "))


def test_no_finding_of_axe_is_critical_or_serious(browser, tmp_path):
    try:
        from axe_playwright_python.sync_playwright import Axe
    except ImportError:
        no_browser("axe-playwright-python, which looks at the pages, is not installed: pip install -e '.[test]'")
    with served(genset(tmp_path / "genset")) as address, window(browser, address, bypass_csp=True) as page:
        expect(page.locator("#headline")).to_have_text(re.compile("^FAIL"))
        Mouse(page).type("#case-0-motions", "half-sine 10 gg 11 ms z")
        expect(page.locator(".refusal")).to_be_visible()
        expect(page.locator("body")).to_have_attribute("data-stale", "false")
        for shown, width, scheme in product(("refused", "keys"), (1280, 390), ("light", "dark")):
            page.emulate_media(color_scheme=scheme)
            page.set_viewport_size({"width": width, "height": 800})
            if shown == "keys" and not page.locator("#keys").is_visible():
                page.locator("[data-canvas=keys]").click()
            found = Axe().run(page).response["violations"]
            heavy = {
                entry["id"]: [node["html"][:120] for node in entry["nodes"]]
                for entry in found
                if entry["impact"] in ("critical", "serious")
            }
            assert not heavy, (shown, width, scheme)


def test_scripts_are_texts_in_every_field(browser, tmp_path):
    with served(genset(tmp_path / "genset")) as address, window(browser, address) as page:
        page.evaluate("for (const part of document.querySelectorAll('details')) part.open = true")
        fields = page.evaluate("""() => [...document.querySelectorAll("input[data-do]:not([type=range])")].map(f => f.id)
            .filter(id => !/^(mounts-m[2-6]|stops-s[2-4]|masses-(alternator|frame))-/.test(id))""")
        assert len(fields) > 40
        for field in fields:
            page.evaluate(
                """([id, text]) => {
                const field = document.getElementById(id);
                if (!field) return;
                field.value = text;
                field.dispatchEvent(new Event("change", { bubbles: true }));
            }""",
                [field, SCRIPT],
            )
        expect(page.locator("#unsaved")).to_be_visible()
        page.locator("[data-do=save]").click()
        expect(page.locator("#unsaved")).to_be_hidden()  # what is said then may be of the search for parts, which takes longer
        expect(page.locator(".refusal").first).to_contain_text("<img/src=x/onerror")
        assert page.locator("img").count() == 0
        assert SCRIPT in page.evaluate("[...document.querySelectorAll('input')].map(field => field.value).join()")


@pytest.mark.slow
def test_buttons_write_what_they_open(browser, tmp_path):
    folder = genset(tmp_path / "genset")
    with served(folder) as address, window(browser, address) as page:
        for asked, name in {"report": "report.html", "timeline": "job.rrd"}.items():
            with page.expect_popup() as popup:
                page.locator(f"[data-do={asked}]").click()
            shown = popup.value
            if asked == "report":
                expect(shown.locator("#headline").first).to_contain_text("FAIL")
            else:
                expect(shown).to_have_title(re.compile("^Timeline"))
                assert "/viewer/" in shown.url
            shown.close()
            assert (folder / "runs" / "job" / name).stat().st_size > 1000
        for asked, name in {"pdf": "report.pdf", "tables": "tables.xlsx"}.items():
            page.locator(f"[data-do={asked}]").click()
            told(page, f"^Written: .*{name}")
            assert (folder / "runs" / "job" / name).stat().st_size > 1000


@pytest.mark.slow
def test_the_board_goes_on_while_a_film_is_made(browser, tmp_path):
    folder = genset(tmp_path / "genset")
    with served(folder) as address, window(browser, address) as page:
        Mouse(page).press("[data-do=film]")
        told(page, "^Computing")
        Mouse(page).move("mount/m1", 5)
        told(page, "^Moved m1")
        expect(page.locator("body")).to_have_attribute("data-stale", "false")
        told(page, "^Written: .*film.mp4")
        assert (folder / "runs" / "job" / "film.mp4").stat().st_size > 1000
