"""Time from the drop of a mount to the verdict in a real browser, from a drag to its preview, and to the first verdict.

    python benchmarks/board.py                 # 4, 12 and 40 mounts, 12 drops each
    python benchmarks/board.py --mounts 4 --rounds 3

One box of 240 kg a mount on two rows of `enidine_wr16_400`, one half-sine of 15 g and 11 ms; medians. It needs playwright and a
Chromium (CHROME names another). Times are read in the page, by an observer of what is drawn; the machine's load is printed.
"""

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

JOB = 'model = "."\n\n[[case]]\nname = "shock"\nhalf-sine = "15 g 11 ms z"\n'
COMMAND = [sys.executable, "-c", "import sys; from wirerope_mj.cli import main; sys.exit(main())", "board"]
DROP = """([name, by]) => new Promise(done => {
    const plan = document.querySelector("#plan"), item = plan.querySelector(`[data-name="${name}"]`);
    const { left, right, top, bottom } = item.getBoundingClientRect(), [x, y] = [(left + right) / 2, (top + bottom) / 2];
    const send = (kind, at) => plan.dispatchEvent(new PointerEvent(kind, {
        clientX: at, clientY: y, pointerId: 1, button: 0, buttons: kind === "pointerup" ? 0 : 1, bubbles: true }));
    plan.setPointerCapture = () => {};
    const times = {}, watched = { subtree: true, childList: true, characterData: true, attributes: true };
    const statics = new MutationObserver(() => {
        statics.disconnect();
        times.preview = performance.now() - began;
        const let_go = performance.now();
        let stale = false;
        new MutationObserver((_, observer) => {
            stale ||= document.body.dataset.stale === "true" && document.querySelector("#said").textContent.startsWith("Moved");
            if (!stale || document.body.dataset.stale !== "false") return;
            observer.disconnect();
            times.verdict = performance.now() - let_go;
            done(times);
        }).observe(document.body, watched);
        document.querySelector("#said").textContent = "";
        send("pointerup", x + by);
    });
    statics.observe(document.querySelector("#statics"), watched);
    const began = performance.now();
    send("pointerdown", x);
    send("pointermove", x + by);
})"""
"""Drag an item by pixels, wait for the preview, let it go, and wait for the verdict; both times [ms]."""


def write_tables(folder: Path, mounts: int) -> None:
    folder.mkdir()
    places = [(300 * (n // 2) - 75 * (mounts - 2), 400 * (n % 2) - 200) for n in range(mounts)]
    rows = "".join(f"m{n + 1}, {x}, {y}, 50, enidine_wr16_400\n" for n, (x, y) in enumerate(places))
    (folder / "mounts.csv").write_text(f"name, x [mm], y [mm], z [mm], isolator\n{rows}", encoding="utf-8")
    (folder / "masses.csv").write_text(
        "name, mass [kg], x [mm], y [mm], z [mm], size_x [mm], size_y [mm], size_z [mm]\n"
        f"box, {240 * mounts}, 0, 0, 350, {150 * mounts}, 600, 500\n",
        encoding="utf-8",
    )
    (folder / "job.toml").write_text(JOB, encoding="utf-8")


def measure(browser: Any, folder: Path, rounds: int) -> tuple[float, list[dict[str, float]]]:
    """Return the time from the command to the first verdict [s], and the times of drops [ms]."""
    began = time.perf_counter()
    with subprocess.Popen([*COMMAND, str(folder), "--no-browser"], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout
            page = browser.new_page(viewport={"width": 1280, "height": 720})
            page.set_default_timeout(120e3)
            page.goto(process.stdout.readline().removeprefix("Open ").strip())
            page.wait_for_selector("#headline")
            first = time.perf_counter() - began
            page.wait_for_timeout(3000)
            times = []
            for number in range(rounds + 1):
                times.append(page.evaluate(DROP, ["mount/m1", 6 if number % 2 else -6]))
                page.wait_for_timeout(3000)  # the verdict with steps chosen anew follows
            page.close()
            return first, times[1:]
        finally:
            process.kill()


def main() -> None:
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mounts", type=int, nargs="+", default=[4, 12, 40])
    parser.add_argument("--rounds", type=int, default=12)
    asked = parser.parse_args()
    program = os.environ.get("CHROME") or shutil.which("chromium")
    with tempfile.TemporaryDirectory() as place, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        for mounts in asked.mounts:
            folder = Path(place) / str(mounts)
            write_tables(folder, mounts)
            first, times = measure(browser, folder, asked.rounds)
            drawn, judged = (statistics.median(each[key] for each in times) for key in ("preview", "verdict"))
            print(
                f"{mounts} mounts: first verdict {first:.1f} s, drag to preview {drawn:.0f} ms, "
                f"drop to verdict {judged:.0f} ms; load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
        browser.close()


if __name__ == "__main__":
    main()
